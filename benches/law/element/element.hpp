#pragma once
#include <cstring>
#include <cstdio>
#include <algorithm>
#include <vector>
#include "dual.hpp"
#include "asperity_contact.h"
const int NS=7, NK=192, NL=24, NM=24, NC=40;
extern double C[NC];
enum { KY,KE,M0,TH,KAPPA,Z0,BETA,BEXP,EPS,U,BEXT,SEXT,CF,NBF,WEXP,RMIN,MX,SMODE,BFADE,NBL,R0,NC1,NC0,BEL,BEX,RH,SR,SP,NBX,WP,WD,WS,WK };
struct Table { double mu, lh0, dl, per; double lnP[NK],D[NK],hp[NK],lnk[NK],gam[NK],nb[NK],c[NK],H[NK];
 double llh0, ldl; double pj[NM+1]; double B[NL][NM+1], A[NL][NM+1], F[NL][NM+1], S[NL][NM+1], xe[NL], cf[NK], rm[NK]; // over zeta = xi/xe for B; over p for A, F, S
 double w[NS]; };
struct State { double hm,h,reach,rho,w,al[2],t[NS][3]; };
struct Out { double FN,FT[2]; double tan[3][3]; int iters,plastic; };
template<class T> struct Col { T P,D,k,gam,hp,nb,c; };
template<class T> inline void columns(const Table&p,const T&hm,Col<T>&c){ T x=(log(hm)-p.lh0)*p.per; double xv=val(x); int i=(int)xv; if(i<0)i=0; if(i>NK-2)i=NK-2; T u=x-(double)i; if(xv<0)u=T(0.0);
 c.P=exp(p.lnP[i]+u*(p.lnP[i+1]-p.lnP[i])); c.k=exp(p.lnk[i]+u*(p.lnk[i+1]-p.lnk[i])); c.D=p.D[i]+u*(p.D[i+1]-p.D[i]); c.hp=p.hp[i]+u*(p.hp[i+1]-p.hp[i]);
 if(xv>NK-1)u=T(1.0);
 c.gam=p.gam[i]+u*(p.gam[i+1]-p.gam[i]); c.nb=p.nb[i]+u*(p.nb[i+1]-p.nb[i]); c.c=p.c[i]+u*(p.c[i+1]-p.c[i]); }
template<class T> inline T lerp(const double*a,int j,const T&u){ return a[j]+u*(a[j+1]-a[j]); }
template<class T> inline void level(const Table&p,const T&hm,int&i,T&u){ T x=(log(hm)-p.llh0)*(1/p.ldl); double v=val(x); i=(int)v; if(i<0)i=0; if(i>NL-2)i=NL-2; u=x-(double)i; if(v<0)u=T(0.0); if(v>NL-1)u=T(1.0); }
// vertex loss at relative distance z = xi/xe
template<class T> inline T vertexB(const Table&p,int li,const T&lu,const T&z){ double zv=val(z); T b0,b1; if(zv>=1){ b0=T(p.B[li][NM]*(1-C[BEXT]))+z*(C[BEXT]*p.B[li][NM]); b1=T(p.B[li+1][NM]*(1-C[BEXT]))+z*(C[BEXT]*p.B[li+1][NM]); }
 else { double s=1-std::sqrt(std::max(0.0,1-zv)); int j=(int)(s*NM); if(j>NM-1)j=NM-1; while(j>0&&zv<p.pj[j])j--; while(j<NM-1&&zv>p.pj[j+1])j++; T u=(z-p.pj[j])*(1/(p.pj[j+1]-p.pj[j])); b0=lerp(p.B[li],j,u); b1=lerp(p.B[li+1],j,u);} return b0+lu*(b1-b0); }
template<class T> inline T over(const double (*tab)[NM+1],const Table&p,int li,const T&lu,const T&pp){ double pv=val(pp); T q=pp; if(pv>1){pv=1;q=T(1.0);} double s=1-std::sqrt(std::max(0.0,1-pv)); int j=(int)(s*NM); if(j>NM-1)j=NM-1; while(j>0&&pv<p.pj[j])j--; while(j<NM-1&&pv>p.pj[j+1])j++; T u=(q-p.pj[j])*(1/(p.pj[j+1]-p.pj[j])); T a=lerp(tab[li],j,u),b=lerp(tab[li+1],j,u); return a+lu*(b-a); }
inline double nbf(double nb){ double x=C[NBF]*(nb-1),l=C[NBL]; return 1+x/std::pow(1+std::pow(x/l,8),1/8.); }
inline void limits(const Table&p,double nb,double lost[NS]){ double ins0=0,below=0; for(int i=0;i<NS;i++){ double ins=std::pow((i+1.0)/NS,C[WEXP]); double end=(i==NS-1)?1.0:std::pow((i+1.0)/NS,C[WEXP]/(nb-1)); double above=ins*end; lost[i]=(nb-1)/nb*(above-below)/(ins-ins0); below=above; ins0=ins; } }
inline double beta_of(const Table&p,double hd){ double f=1-1/hd; if(f<0)f=0; return C[BETA]*std::pow(p.mu/0.3,C[BEXP])*std::pow(f,C[BFADE]); }
template<class T> struct Ev { T FN,FT[2],t[NS][3],P,g,al[2],reach,hm,hp,lam,R,res; double G0; };
inline double m_of(double hd){ double f=1-1/hd; if(f<0)f=0; return C[M0]*std::pow(f,C[SEXT]); }
inline double bel_of(const Table&p){ return C[BEL]*std::pow(p.mu/0.3,C[BEX]); }
struct Step { double m,bel; double lost[NS],beta,G0; };
template<class T> inline T yieldG(const Table&p,int li,const T&lu,const T&pp,const T&xi){ T xe=p.xe[li]+lu*(p.xe[li+1]-p.xe[li]); return 1.0+over(p.A,p,li,lu,pp)+vertexB(p,li,lu,xi/xe); }
template<class T> inline void evaluate(const Table&p,const State&s,const Step&st,const T&h,const T dd[2],const T&y,const T r[2],Ev<T>&o,bool flow){
 T r2=r[0]*r[0]+r[1]*r[1]; T hm=s.hm+y; Col<T> c; columns(p,hm,c); o.hm=hm;o.hp=c.hp;o.P=c.P; Col<double> c0; columns<double>(p,s.hm,c0);
 T dhp=c.hp-c0.hp; o.lam=dhp; T e=h-c.hp; int li; T lu; level(p,hm,li,lu); double eps=C[EPS]*p.mu; T rr=val(r2)>1e-30?sqrt(r2):T(0.0); T pp=rr*(1/p.mu);
 T x0=r[0]-s.al[0],x1=r[1]-s.al[1]; T d0=sqrt(x0*x0+x1*x1+eps*eps);
 T q=dhp*c.k/(c.P*(C[KAPPA]*p.mu));
 T den=1.0+q*(1.0+C[Z0]*p.mu/d0); o.al[0]=r[0]-x0/den; o.al[1]=r[1]-x1/den; x0=x0/den;x1=x1/den; T xi2=x0*x0+x1*x1; T xi=val(xi2)>1e-24?sqrt(xi2):T(0.0); T dv=sqrt(xi2+eps*eps);
 o.g=yieldG(p,li,lu,pp,xi);
 if(!(val(e)>0)){ o.FN=T(0.0);o.FT[0]=o.FT[1]=T(0.0);for(int i=0;i<NS;i++)o.t[i][0]=o.t[i][1]=o.t[i][2]=T(0.0); o.reach=T(s.reach); return; }
 o.FN=c.P*exp(log(e/c.D)*c.gam);
 T n0=T(0.0),n1=T(0.0); T dQ=T(0.0);
 if(flow){ T dG=o.g-st.G0; dQ=dhp*st.m; if(val(dG)>0){ T xe=p.xe[li]+lu*(p.xe[li+1]-p.xe[li]); T zz=xi/xe-1.0; T s=over(p.S,p,li,lu,pp); if(val(zz)>0) s=s*(1.0+C[SR]*zz)+zz*C[SP]; dQ=dQ+dG*c.D*s; } T f=dhp*over(p.F,p,li,lu,pp)/(rr+1e-9); n0=f*r[0]+dQ*x0/dv; n1=f*r[1]+dQ*x1/dv; }
 o.reach=flow||val(e)>s.reach?e:T(s.reach); T eta=flow?T(1.0):exp(log(e/o.reach)*c.gam*(1.0/val(c.nb))); if(val(eta)>1)eta=T(1.0);
 T lim[NS],sum=T(0.0); for(int i=0;i<NS;i++){ lim[i]=eta-st.lost[i]; if(val(lim[i])<0)lim[i]=T(0.0); if(i==0&&val(lim[0])<0.1*val(eta))lim[0]=0.1*eta; sum=sum+p.w[i]*lim[i]; }
 T sc=p.mu*o.FN/sum; T q0=dd[0]-n0,q1=dd[1]-n1,qr=st.beta*dhp+st.bel*((h-s.h)-dhp); o.FT[0]=o.FT[1]=T(0.0);
 for(int i=0;i<NS;i++){ T k=c.k*p.w[i]; T t0=s.t[i][0]+k*q0,t1=s.t[i][1]+k*q1,t2=s.t[i][2]+k*qr; T L=p.w[i]*lim[i]*sc; if(val(t2)>C[RH]*val(L))t2=C[RH]*L; else if(val(t2)<-C[RH]*val(L))t2=-C[RH]*L; double sz=val(t0)*val(t0)+val(t1)*val(t1)+val(t2)*val(t2); if(sz>val(L)*val(L)){ T f=L/sqrt(t0*t0+t1*t1+t2*t2); t0=t0*f;t1=t1*f;t2=t2*f; } o.t[i][0]=t0;o.t[i][1]=t1;o.t[i][2]=t2;o.FT[0]=o.FT[0]+t0;o.FT[1]=o.FT[1]+t1; }
}
inline bool solve3(double A[3][3],double b[3]){ for(int i=0;i<3;i++){int k=i;for(int j=i+1;j<3;j++)if(std::fabs(A[j][i])>std::fabs(A[k][i]))k=j; if(A[k][i]==0)return false; if(k!=i){for(int j=0;j<3;j++)std::swap(A[i][j],A[k][j]);std::swap(b[i],b[k]);} for(int j=i+1;j<3;j++){double f=A[j][i]/A[i][i];for(int l=i;l<3;l++)A[j][l]-=f*A[i][l];b[j]-=f*b[i];}} for(int i=2;i>=0;i--){for(int j=i+1;j<3;j++)b[i]-=A[i][j]*b[j];b[i]/=A[i][i];} return true;}
inline void begin(const Table&p,State&s){ memset(&s,0,sizeof s); s.rho=1; s.hm=p.H[0]; }
template<class T> inline T newrho(const T&lam,double rho,double D){ if(rho>=1-1e-12) return T(1.0); double y0=-std::log(rho); return exp(-1.0/(1.0/y0+(C[U]/D)*lam)); }
inline bool step(const Table&p,const State&s0,double h,const double dd[2],State&s,Out&o){
 typedef Dual<3> T; o.iters=0;o.plastic=0; Step st; Col<double> c0; columns<double>(p,s0.hm,c0);
 double nb=nbf(c0.nb); if(s0.w>0){ double later=1+C[NBX]; if(later<nb) nb+=s0.w*(later-nb); } limits(p,nb,st.lost); st.beta=beta_of(p,s0.hm/c0.D); st.m=m_of(s0.hm/c0.D); st.bel=bel_of(p);
 double r[2]={0,0}; Ev<double> e; evaluate<double>(p,s0,st,h,dd,0.0,r,e,false);
 double e0=s0.h-c0.hp,e1=h-c0.hp,rho=s0.rho; if(e1<e0&&e0>0){ double q=e1>0?std::pow(e1/e0,c0.gam):0; rho=std::max(rho*q,C[RMIN]); }
 auto accept=[&](const Ev<double>&e,double rh){ s.hm=e.hm;s.h=h;s.reach=e.reach;s.rho=rh;s.al[0]=e.al[0];s.al[1]=e.al[1];memcpy(s.t,e.t,sizeof s.t); { double a=std::sqrt(e.al[0]*e.al[0]+e.al[1]*e.al[1]),w=s0.w*std::exp(-C[WD]*(e.hp-c0.hp)/c0.D); if(a>0&&e.FN>0){ double x=-(e.FT[0]*e.al[0]+e.FT[1]*e.al[1])/(e.FN*p.mu*a); if(x>0){ x=std::pow(std::min(x,1.0),C[WP])*a/(a+.02*p.mu); if(x>w)w=x; } } s.w=w; } o.FN=e.FN;o.FT[0]=e.FT[0];o.FT[1]=e.FT[1]; };
 if(!(e.FN>0)){ accept(e,rho); s.al[0]=s0.al[0];s.al[1]=s0.al[1]; s.h=h; return true; }
 r[0]=e.FT[0]/e.FN;r[1]=e.FT[1]/e.FN; evaluate<double>(p,s0,st,h,dd,0.0,r,e,false);
 if(e.FN*e.g<=rho*e.P*(1+1e-11)){ accept(e,rho); return true; }
 o.plastic=1;
 // place of the yield factor from which it grows
 { double FT0[2]={0,0},FN0=e0>0?c0.P*std::pow(e0/c0.D,c0.gam):0; for(int i=0;i<NS;i++){FT0[0]+=s0.t[i][0];FT0[1]+=s0.t[i][1];} double g0=1; if(FN0>0){ double a=FT0[0]/FN0,b=FT0[1]/FN0,x=a-s0.al[0],y=b-s0.al[1]; int li;double lu;level<double>(p,s0.hm,li,lu); g0=yieldG<double>(p,li,lu,std::sqrt(a*a+b*b)/p.mu,std::sqrt(x*x+y*y)); }
   st.G0=std::max(g0,s0.rho*c0.P/e.FN); }
 double D0=c0.D,y=0,last=1e300,px[3]={0,r[0],r[1]},stp[3]={0,0,0},ymax=std::max(e1,0.0)+s0.hm; int back=0; bool ok=false; Ev<T> E; double scale=D0;
 for(int it=0;it<40;it++){ o.iters++; T Y(y),rr[2]={T(r[0]),T(r[1])},H(h),DD[2]={T(dd[0]),T(dd[1])}; Y.d[0]=1;rr[0].d[1]=1;rr[1].d[2]=1;
  evaluate<T>(p,s0,st,H,DD,Y,rr,E,true); bool bad=!(E.FN.v>0); double nrm=1e300; T res[3];
  if(!bad){ res[0]=E.FN*E.g/E.P-newrho<T>(E.lam,rho,D0); res[1]=E.FT[0]/E.FN-rr[0]; res[2]=E.FT[1]/E.FN-rr[1]; nrm=std::fabs(res[0].v)+std::fabs(res[1].v)+std::fabs(res[2].v); }
  if(nrm<1e-9){ok=true;break;}
  if(it>0&&(bad||nrm>1.05*last)&&back<6){ back++; for(int i=0;i<3;i++)stp[i]*=0.4; y=px[0]+stp[0];r[0]=px[1]+stp[1];r[1]=px[2]+stp[2]; continue; }
  if(bad) return false;
  back=0;last=nrm; double A[3][3],b[3]; for(int i=0;i<3;i++){b[i]=-res[i].v;for(int j=0;j<3;j++)A[i][j]=res[i].d[j]; A[i][0]*=scale;} if(!solve3(A,b))return false;
  px[0]=y;px[1]=r[0];px[2]=r[1]; stp[0]=b[0]*scale;stp[1]=b[1];stp[2]=b[2]; if(y+stp[0]<0)stp[0]=-0.7*y; if(y+stp[0]>ymax)stp[0]=0.7*(ymax-y); double mx=std::max(std::fabs(b[1]),std::fabs(b[2])),lm=0.5*p.mu+0.01; if(mx>lm){stp[1]*=lm/mx;stp[2]*=lm/mx;} y+=stp[0];r[0]+=stp[1];r[1]+=stp[2]; }
 if(!ok) return false;
 evaluate<double>(p,s0,st,h,dd,y,r,e,true); accept(e,newrho<double>(e.lam,rho,D0)); return true; }
inline int advance(const Table&p,const State&s0,double h,const double dd[2],State&s,Out&o,int depth=0){ if(step(p,s0,h,dd,s,o))return 1; if(depth>=10){ s=s0;s.h=h; return 0; } State m; Out om; double hf[2]={.5*dd[0],.5*dd[1]}; int a=advance(p,s0,.5*(s0.h+h),hf,m,om,depth+1),b=advance(p,m,h,hf,s,o,depth+1); o.iters+=om.iters; return a&&b; }

// columns from a table of today's law, then the shapes from its virgin shear
inline double shape(const asperity_table*t,const asperity_curve*v,int kind,double x){ if(t->form==2){ if(x>1)x=1; return asperity_given(v,kind,x,asperity_point_before(x)); } return 0; }
inline void columns_of(const asperity_table*t,Table&p){ p.mu=t->friction; p.lh0=std::log(t->first); p.dl=(std::log(1.5*t->deepest)-p.lh0)/(NK-1); p.per=1/p.dl;
 for(int i=0;i<NK;i++){ double h=std::exp(p.lh0+i*p.dl); asperity_curve v; asperity_first_loading(t,h,1,&v); double W=1+C[WS]*v.per_a/v.radii/v.per_slip; p.H[i]=h;p.lnP[i]=std::log(v.f_n0);p.D[i]=std::min(v.depth*W,h);p.lnk[i]=std::log(v.k_t)-C[WK]*std::log(W);p.gam[i]=v.gamma;p.nb[i]=v.backbone;p.c[i]=v.n; p.hp[i]=h-p.D[i]; if(i==0){p.hp[0]=0;p.D[0]=h;} else if(p.hp[i]<=p.hp[i-1]+1e-7*h*p.dl){ p.hp[i]=p.hp[i-1]+1e-7*h*p.dl; p.D[i]=h-p.hp[i]; } }
 p.llh0=p.lh0; p.ldl=(std::log(t->deepest)-p.lh0)/(NL-1); for(int j=0;j<=NM;j++){ double a=1-(double)j/NM; p.pj[j]=1-a*a; } }

inline double afun(double c,double r){ return C[KY]*c*r*r*r/(r+C[R0]+1e-12); }
inline double smin(double a,double b){ if(!(a>0)||!(b>0))return 0; double n=C[MX],q=a/b; return q>1? b/std::pow(1+std::pow(1/q,n),1/n):a/std::pow(1+std::pow(q,n),1/n); }

// flow coefficient of the steady oblique press that the table has measured: the sliders are driven to its F_T, what is left of its displacement has flowed
inline void steady(const asperity_table*t,Table&p){ double mu=p.mu,sl=2*mu/(1+.5*mu*mu); static double hp[NK],dp[NK],rm[NK]; double tx[NS]={0},tr[NS]={0},u=0,hb=0;
 for(int i=0;i<NK;i++){ double h=p.H[i],r=0,e=0,A=0; for(int k=0;k<6;k++){ double x=(std::log(std::min(h,t->deepest))-p.lh0)*p.per; int j=std::max(0,std::min(NK-2,(int)x)); double f=x-j; if(f<0)f=0; double c=p.c[j]+f*(p.c[j+1]-p.c[j]); c*=C[CF]*std::pow(p.H[i]/p.D[i]/8,C[KE]); r=(std::sqrt(1+sl*sl/c)-1)/sl; if(r>.97*mu)r=.97*mu; A=afun(c,r); e=p.D[i]*std::pow(1+A,-1/p.gam[i]); h=p.hp[i]+e; }
  double F=std::exp(p.lnP[i])/(1+A),k=std::exp(p.lnk[i]),lost[NS],sum=0; limits(p,nbf(p.nb[i]),lost); for(int q=0;q<NS;q++)sum+=p.w[q]*(1-lost[q]); double dpl=p.hp[i]-(i?p.hp[i-1]:0); double be=beta_of(p,p.H[i]/p.D[i])*dpl+bel_of(p)*(h-hb-dpl); 
  auto force=[&](double du,double*nx,double*nr){ double S=0; for(int q=0;q<NS;q++){ double a=tx[q]+k*p.w[q]*du,b=tr[q]+k*p.w[q]*be,lim=mu*F*p.w[q]*(1-lost[q])/sum; if(b>C[RH]*lim)b=C[RH]*lim; double sz=std::sqrt(a*a+b*b); if(sz>lim){a*=lim/sz;b*=lim/sz;} S+=a; if(nx){nx[q]=a;nr[q]=b;} } return S; };
  double lo=0,hi=sl*(h-hb); if(force(hi,0,0)>r*F){ for(int z=0;z<40;z++){ double mid=.5*(lo+hi); if(force(mid,0,0)<r*F)lo=mid; else hi=mid; } } double nx[NS],nr[NS]; force(hi,nx,nr); memcpy(tx,nx,sizeof tx);memcpy(tr,nr,sizeof tr); u+=hi; hb=h; hp[i]=p.hp[i]; rm[i]=r; dp[i]=sl*h-u; }
 for(int i=0;i<NK;i++){ int a=std::max(0,i-4),b=std::min(NK-1,i+4); double x=(std::log(t->deepest)-p.lh0)*p.per-2; if(b>x){b=(int)x; if(a>b-8)a=b-8;} double f=(dp[b]-dp[a])/(hp[b]-hp[a]); double r=rm[std::min(i,b)]; double c=p.c[i]; p.rm[i]=r; double v=f/(2*r+f*afun(1,r)); if(!(v>0.3*c))v=0.3*c; if(v>3*c)v=3*c; p.cf[i]=v; } }
inline void build(const asperity_table*t,Table&p){
 double ins0=0; for(int i=0;i<NS;i++){ double ins=std::pow((i+1.0)/NS,C[WEXP]); p.w[i]=ins-ins0; ins0=ins; }
 steady(t,p);
 double rad[NS]={0}; double hl=0,hpb0=0; 
 for(int L=0;L<NL;L++){ double H=std::exp(p.llh0+L*p.ldl); Col<double> c; double lost[NS];
  int n=L?8:16; for(int k=1;k<=n;k++){ double h=L?hl*std::pow(H/hl,k/(double)n):H*k/n; if(h<p.H[0]){ columns<double>(p,p.H[0],c); double f=h/p.H[0]; c.P*=std::pow(f,c.gam); c.D=h; } else columns<double>(p,h,c); limits(p,nbf(c.nb),lost); double be=beta_of(p,std::max(h,1e-300)/c.D); double hb=L?hl*std::pow(H/hl,(k-1)/(double)n):H*(k-1)/n,sum=0; for(int i=0;i<NS;i++)sum+=p.w[i]*(1-lost[i]); double hpn=h<p.H[0]?0:c.hp,dpl=hpn-hpb0; hpb0=hpn; for(int i=0;i<NS;i++){ rad[i]+=c.k*p.w[i]*(be*dpl+bel_of(p)*(h-hb-dpl)); double lim=p.mu*c.P*p.w[i]*(1-lost[i])/sum; lim*=C[RH]; if(rad[i]>lim)rad[i]=lim; if(rad[i]<-lim)rad[i]=-lim; } }
  hl=H; columns<double>(p,H,c); asperity_curve v; asperity_first_loading(t,H,1,&v); limits(p,nbf(c.nb),lost); double sum=0; for(int i=0;i<NS;i++)sum+=p.w[i]*(1-lost[i]);
  double gi=(std::log(H)-p.lh0)*p.per; int g0=std::min(NK-2,(int)gi); double cf=p.cf[g0]+(gi-g0)*(p.cf[g0+1]-p.cf[g0]),rmg=p.rm[g0],rec=v.slope*v.depth/(v.gamma*v.f_n0); auto fss=[&](double r){ double x=std::min(2.0,r/rmg),q=cf*std::max(.2,1+C[NC1]*(rec-C[NC0])*(x-1)); return 2*q*r/std::max(.02,1-afun(cf,r)); };
  double tx[NS]={0},tr[NS]; memcpy(tr,rad,sizeof tr); const int NX=144; static double pp[NX+1],gg[NX+1],xx[NX+1],hh[NX+1],vv[NX+1],la[NX+1],LL[NX+1],dd_[NX+1]; dd_[0]=0; pp[0]=0;gg[0]=1;xx[0]=0;hh[0]=c.hp;LL[0]=0; int m=0; double al=0,hpb=c.hp,dlt=0,hm=H,u=0; double end=1/v.per_slip;
  for(int k=1;k<=NX;k++){ double x=(double)k/NX; x=x*x; double FN=v.f_n0-(v.f_n0-v.f_n_slip)*shape(t,&v,1,x), FT=p.mu*v.f_n_slip*shape(t,&v,0,x); double r=FT/FN; if(r>0.999*p.mu)r=0.999*p.mu; if(r<=pp[m]*p.mu+1e-9*p.mu) { if(pp[m]>0.99)break; continue; }
   double lo=hm,hi=hm+H; for(int b=0;b<50;b++){ double mid=.5*(lo+hi); Col<double>cm; columns<double>(p,mid,cm); double e=H-cm.hp; double F=e>0?cm.P*std::pow(e/cm.D,cm.gam):0; if(F>FN)lo=mid; else hi=mid; }
   hm=.5*(lo+hi); Col<double>cm; columns<double>(p,hm,cm); double dh=std::max(cm.hp-hpb,0.0); hpb=cm.hp;
   double q=dh*cm.k/(cm.P*C[KAPPA]*p.mu),eps=C[EPS]*p.mu,d0=std::sqrt((r-al)*(r-al)+eps*eps),xi=(r-al)/(1+q*(1+C[Z0]*p.mu/d0)); al=r-xi;
   double G=cm.P/FN,d=x*end; 
   auto force=[&](double du,double*nx,double*nr){ double S=0; for(int i=0;i<NS;i++){ double a=tx[i]+cm.k*p.w[i]*du,b=tr[i],lim=p.mu*FN*p.w[i]*(1-lost[i])/sum; if(b>C[RH]*lim)b=C[RH]*lim; double sz=std::sqrt(a*a+b*b); if(sz>lim){a*=lim/sz;b*=lim/sz;} S+=a; if(nx){nx[i]=a;nr[i]=b;} } return S; };
   double target=r*FN; double ulo=0,uhi=d-dlt; if(force(uhi,0,0)>target){ for(int b=0;b<45;b++){ double mid=.5*(ulo+uhi); if(force(mid,0,0)<target)ulo=mid; else uhi=mid; } } double nx[NS],nr[NS]; force(uhi,nx,nr); memcpy(tx,nx,sizeof tx);memcpy(tr,nr,sizeof tr); u+=uhi; dlt=d;
   double dv=std::sqrt(xi*xi+eps*eps); m++; pp[m]=r/p.mu; gg[m]=std::max(G,gg[m-1]+1e-7*r/p.mu); xx[m]=std::max(xi,xx[m-1]+1e-6*p.mu); hh[m]=cm.hp; vv[m]=xx[m]/dv; la[m]=al; LL[m]=d-u; dd_[m]=d-r*FN/cm.k; if(pp[m]>0.9985)break; }
  if(m==0){ m=1; pp[1]=1;gg[1]=1+1e-7;xx[1]=p.mu;hh[1]=c.hp;vv[1]=1;LL[1]=0;dd_[1]=0; }
  auto at=[&](const double*X,const double*Y,double x){ int i=0; while(i<m-1&&X[i+1]<x)i++; double f=(x-X[i])/(X[i+1]-X[i]); if(f>1&&i==m-1)f=1; return Y[i]+f*(Y[i+1]-Y[i]); };
  double xe=xx[m]; p.xe[L]=xe; double pe=pp[m]; double Qs=0; (void)Qs;
  for(int j=0;j<=NM;j++){ double P=p.pj[j],r=P*p.mu,G=at(pp,gg,P*pe); p.A[L][j]=smin(afun(cf,r),C[TH]*(G-1));
   double a=P-0.5*(P-p.pj[j>0?j-1:0]),b=P+0.5*((j<NM?p.pj[j+1]:1)-P); a*=pe;b*=pe; double dG=at(pp,gg,b)-at(pp,gg,a),dl=at(pp,LL,b)-at(pp,LL,a),dh=at(pp,hh,b)-at(pp,hh,a); double left=dl-dh*m_of(H/c.D)*at(pp,vv,P*pe); if(left<0)left=0; double tot=(b-a)/pe>0?(at(pp,dd_,b)-at(pp,dd_,a)):0; double fs=fss(r); double f=dh>1e-12*c.D?smin(fs,tot/dh):fs; p.F[L][j]=f; left-=f*dh; p.S[L][j]=left>0?left/std::max(dG,1e-9)/c.D/at(pp,vv,P*pe):0; }
  p.S[L][0]=p.S[L][1]; p.S[L][NM]=p.S[L][NM-1]; p.F[L][NM]=std::max(p.F[L][NM-1],p.F[L][NM]);
  for(int j=0;j<=NM;j++){ double xi=p.pj[j]*xe,P=at(xx,pp,xi)/pe; int i; double lu=0; (void)lu; i=0; while(i<NM-1&&p.pj[i+1]<P)i++; double f=(P-p.pj[i])/(p.pj[i+1]-p.pj[i]); double A=p.A[L][i]+std::min(f,1.0)*(p.A[L][i+1]-p.A[L][i]); double B=at(xx,gg,xi)-1-A; p.B[L][j]=std::max(B,j?p.B[L][j-1]:0.0); }
  p.B[L][0]=0; if(getenv("SHOW")){ printf("level %g h/D %.1f xe/mu %.3f pend %.4f c %.2f cf %.2f\n",H,H/c.D,xe/p.mu,pp[m],c.c,cf); for(int j=0;j<=NM;j+=3)printf("  p %.3f A %.4f F %.4f S %.4f B %.4f\n",p.pj[j],p.A[L][j],p.F[L][j],p.S[L][j],p.B[L][j]); } }
}
