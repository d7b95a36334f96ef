import sys,pathlib,subprocess,math,csv,json,os
sys.path.insert(0,'/work/main/benches/law')
import fit_update as F
NAMES="KY KE M0 TH KAPPA Z0 BETA BEXP EPS U BEXT SEXT CF NBF WEXP RMIN MX SMODE BFADE NBL R0 NC1 NC0 BEL BEX RH SR SP NBX WP WD WS WK".split()
START=dict(KY=.75,KE=0,M0=.76,TH=.98,KAPPA=1.67,Z0=.2,BETA=.155,BEXP=1,EPS=.17,U=240,BEXT=1,SEXT=1,CF=1,NBF=1,WEXP=.65,RMIN=.001,MX=4,SMODE=0,BFADE=0.0,NBL=1,R0=0.05,NC1=0,NC0=.15,BEL=0,BEX=0,RH=1e9,SR=0,SP=0,NBX=1,WP=6,WD=1,WS=0,WK=0)
ERR={}
for r in csv.DictReader(open('/work/main/fixtures/paths/errors.csv')):
    ERR[r['contact'],r['path']]=max(float(r['F_N']),float(r['F_T']))
class M:
    def __init__(s,inc=4,more=(),exe='./drive',proto=True):
        contacts=list(F.protocol()) if proto else []
        laws=[f'laws/{n}/law.asperity' for n,_,_ in contacts]
        for run,table in more:
            c=F.more(run,table); contacts.append((c[0],c[1],{c[0]:c[2]['path']})); l=f'laws/{c[0]}'
            if not os.path.exists(l): subprocess.run(['/tmp/fit/asperity','law','export',table,'--format','c','--out',l],check=True,stdout=subprocess.DEVNULL)
            laws.append(l+'/law.asperity')
        s.paths=[];lines=[]
        for i,(n,_,ps) in enumerate(contacts):
            for k,rows in ps.items():
                s.paths.append((n,k,rows)); lines.append(f"{i} {len(rows)}"); lines+= [f"{r[0]!r} {r[1]!r}" for r in rows]
        s.p=subprocess.Popen([exe,str(inc),*laws],stdin=subprocess.PIPE,stdout=subprocess.PIPE,text=True)
        s.p.stdin.write(f"{len(s.paths)}\n"+"\n".join(lines)+"\n")
        s.counts=[ERR.get((n,k),0)<=2.5 for n,k,_ in s.paths]
        s.peaks=[]
        for n,k,rows in s.paths:
            g=max(r[2] for r in rows); s.peaks.append([max(.01*g,max(abs(r[c]) for r in rows)) for c in (3,2)])
    def run(s,th):
        v=[th[n] for n in NAMES]; s.p.stdin.write(f"{len(v)} "+" ".join(map(repr,v))+"\n"); s.p.stdin.flush(); out=[]
        for n,k,rows in s.paths: out.append([list(map(float,s.p.stdout.readline().split())) for _ in rows])
        s.stat=s.p.stdout.readline().split(); return out
    def scores(s,th):
        res=[]
        for (n,k,rows),ans,pk in zip(s.paths,s.run(th),s.peaks):
            o=[]
            for f,c,p in ((3,1,pk[0]),(2,0,pk[1])):
                e=[abs(a[c]-r[f])/p for a,r in zip(ans,rows)]; e=[x if x==x else 9 for x in e]
                o+=[math.sqrt(sum(x*x for x in e)/len(e)),max(e)]
            res.append(o)
        return res
beyond=F.beyond
def told(m,sc,detail=False):
    kinds={}
    for (n,k,_),o,c in zip(m.paths,sc,m.counts): kinds.setdefault(k,[]).append((o,c))
    for k,v in kinds.items():
        w=[sum(beyond(o)<=1 for o,c in v if c),sum(c for o,c in v)]; r=[100*math.sqrt(sum(o[i]**2 for o,c in v if c)/max(1,w[1])) for i in (0,2)]; x=[100*max(o[i] for o,_ in v) for i in (1,3)]
        print(f"{k:30} {w[0]:2} of {w[1]:2}  F_T {r[0]:5.2f} ({x[0]:5.1f})  F_N {r[1]:5.2f} ({x[1]:5.1f})"+("   "+" ".join(f"{100*o[0]:4.1f}/{100*o[2]:3.1f}"+("*" if beyond(o)>1 else " ") for o,c in v) if detail else ""))
    ok=[o for o,c in zip(sc,m.counts) if c]; r=[100*math.sqrt(sum(o[i]**2 for o in ok)/len(ok)) for i in (0,2)]
    print(f"all: {sum(beyond(o)<=1 for o in ok)} of {len(ok)} (of 99: {sum(beyond(o)<=1 for o in sc)}), F_T {r[0]:.2f} F_N {r[1]:.2f}; cost {cost(m,sc):.4f}; {m.stat}",flush=True)
def cost(m,sc):
    q=[beyond(o)**4 for o,c in zip(sc,m.counts) if c]; return sum(x/(1+x) for x in q)/len(q)
def fit(m,th,free,rounds=4,step=.25,cost=cost,say=True):
    best=dict(th);least=cost(m,m.scores(best)); st={k:step*max(abs(best[k]),.1) for k in free}
    for rd in range(rounds):
        for k in free:
            for sg in (1,-1):
                t=dict(best);t[k]+=sg*st[k]; f=cost(m,m.scores(t))
                if f<least-1e-6: best,least=t,f; st[k]*=1.4*sg; break
            else: st[k]*=.5
        if say: print(rd,round(least,4),{k:round(best[k],4) for k in free},flush=True)
    return best
def more():
    out=[]
    for p in sorted(pathlib.Path('/tmp/fit/runs').iterdir()):
        t=pathlib.Path('/tmp/fit/tables')/p.name/'law.json'
        if t.exists() and (p/'summary.json').exists(): out.append((str(p),str(t)))
    return out
if __name__=='__main__':
    m=M(); import time; t=time.time(); sc=m.scores(START); print(time.time()-t); told(m,sc,True)
