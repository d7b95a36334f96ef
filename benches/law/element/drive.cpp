#include "element.hpp"
double C[NC];
static asperity_table tables[64]; static Table T[64];
static std::vector<double> H,D; static int of[2000],cnt[2000];
int main(int argc,char**argv){ int contacts=argc-2,INC=atoi(argv[1]); for(int i=0;i<contacts;i++){ if(asperity_read_table(argv[i+2],&tables[i])){fprintf(stderr,"bad %s\n",argv[i+2]);return 2;} }
 int paths; if(scanf("%d",&paths)!=1)return 2; for(int n=0;n<paths;n++){ if(scanf("%d %d",&of[n],&cnt[n])!=2)return 2; for(int i=0;i<cnt[n];i++){double a,b; if(scanf("%lf %lf",&a,&b)!=2)return 2; H.push_back(a);D.push_back(b);} }
 
 int nc; for(;;){ if(scanf("%d",&nc)!=1)return 0; for(int i=0;i<nc;i++) if(scanf("%lf",&C[i])!=1)return 0; if(nc==0) continue;
  for(int i=0;i<contacts;i++){ columns_of(&tables[i],T[i]); build(&tables[i],T[i]); }
  size_t all=0; long fails=0,upd=0,its=0; for(int n=0;n<paths;n++){ const Table&t=T[of[n]]; State s; begin(t,s); Out o; memset(&o,0,sizeof o); double h0=0,d0=0; for(int i=0;i<cnt[n];i++,all++){ double h=H[all],d=D[all]; for(int k=1;k<=INC;k++){ double dd[2]={(d-d0)/INC,0}; State x; fails+=!advance(t,s,h0+(h-h0)*k/INC,dd,x,o); s=x; upd++; its+=o.iters; } Col<double> c; columns<double>(t,s.hm,c); printf("%.8g %.8g %.6g %.6g %.6g %.6g %.6g %.6g %d\n",o.FN,o.FT[0],s.hm,c.hp,s.al[0],s.rho,s.reach,c.P,o.plastic); h0=h;d0=d; } }
  printf("%ld %ld %ld\n",fails,upd,its); fflush(stdout); } }
