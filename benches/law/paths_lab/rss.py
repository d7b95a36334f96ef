import csv,glob,re,os,sys
d=sys.argv[1]
for f in sorted(glob.glob(d+'/*oblique*.csv')):
    n=os.path.basename(f)[:-4]
    m=re.search(r'mu-([\d.]+)-',n); 
    mu=float(m.group(1)) if m else {'po':.3,'u1':.4,'u2':.15,'u3':.5,'u4':.2,'u5':.45,'u6':.25,'u7':.2,'u8':.7}[n[:2]]
    R=[{k:float(v) for k,v in r.items()} for r in csv.DictReader(open(f))]
    R=[r for r in R if r['seg']==0]
    pick=[R[i] for i in (3,6,10,14,18) if i<len(R)]
    print('%-45s'%n, '  '.join('%.2f %.2f'%(r['FT']/r['FN']/mu, r['lT']/r['lN']/mu) for r in pick), '  N: ','  '.join('%.2f'%(r['lN']/r['FN']) for r in pick))
