import csv,sys,re
mu=float(re.search(r'mu-([\d.]+)',sys.argv[1]).group(1))
for f in sys.argv[1:]:
    R=[{k:float(v) for k,v in r.items()} for r in csv.DictReader(open(f))]
    print(f.split('/')[-1])
    nm=max(r['FN'] for r in R); tm=max(max(abs(r['FT']) for r in R),.01*nm)
    for i,r in enumerate(R):
        print('%3d s%d h %.5f d %8.5f  N %.3f %.3f (%+5.1f%%)  T %+.3f %+.3f (%+5.1f%%)  r/mu %.2f %.2f'%(i+1,r['seg'],r['h'],r['d'],r['FN']/nm,r['lN']/nm,100*(r['lN']-r['FN'])/nm,r['FT']/tm,r['lT']/tm,100*(r['lT']-r['FT'])/tm,r['FT']/max(r['FN'],1e-12)/mu,r['lT']/max(r['lN'],1e-12)/mu))
