/* Universal constants of the element, as benches/law/fit_element.py --fit --write has made them. */
#ifndef ASPERITY_ELEMENT_CONSTANTS_H
#define ASPERITY_ELEMENT_CONSTANTS_H

#define ELEMENT_LOSS 1.0287 /* A = this c r^3/(r + the next): share of the yield force that a steady press loses at r = F_T/F_N */
#define ELEMENT_LOSS_SMALL 0.061897 /* the r below which it loses less than with r^2 */
#define ELEMENT_LOSS_MOST 0.87951 /* greatest A over what the table's shear loses at the same r */
#define ELEMENT_VERTEX_FLOW 0.71054 /* slip at the vertex over dh_p, of a contact that is all plastic */
#define ELEMENT_VERTEX_FADES 8.593 /* it fades with exp(-this (D/h)^2) */
#define ELEMENT_VERTEX_LENGTH 1.3489 /* dh_p over mu P/k_T in which the vertex follows r */
#define ELEMENT_VERTEX_ROUND 0.30374 /* distance over mu within which its direction is rounded */
#define ELEMENT_BEYOND 1.6588 /* slope of its loss beyond the shear's end, over the mean slope before */
#define ELEMENT_BEYOND_FADES 2.2251 /* its power of 1 - D/h */
#define ELEMENT_RADIAL 0.35424 /* radial slip of a press over dh_p, of a contact that is all plastic */
#define ELEMENT_RADIAL_FADES 2.0443 /* its power of 1 - D/h */
#define ELEMENT_RADIAL_MOST 0.48872 /* greatest radial force of a slider over its limit */
#define ELEMENT_FIRST 0.87244 /* n - 1 of a first reversal over that of the table */
#define ELEMENT_FIRST_MOST 0.6 /* the greatest such n - 1 */
#define ELEMENT_LATER 0.17506 /* n - 1 of reversals after the first, at most, at mu = 0.3 */
#define ELEMENT_LATER_MU 0.6753 /* its power of mu */
#define ELEMENT_UNSHEARED 3.3321 /* n of a contact that is not sheared and all plastic */
#define ELEMENT_FORGETS 2.0 /* how fast a press takes back how far it was sheared, over dh_p/D */
#define ELEMENT_RELEASED 0.38137 /* share of the yield force that a whole release takes, of a contact that is all plastic */
#define ELEMENT_RECOVERS 415.85 /* how fast a press gives it back */
#define ELEMENT_WIDENS 0.095977 /* growth of the contact radius over delta_T_end/a0 that is in a table's unloading */
#define ELEMENT_STIFFENS 2.3201 /* power of that growth that is in its k_T */
#define ELEMENT_NARROWS 0.035155 /* dh_p/D in which a press makes the contact as wide as F_N has it */
#define ELEMENT_COARSE 0.16448 /* power of (h/D over the next) by which the c of a table on a coarse mesh is too small, times 1 - 0.1/mu */
#define ELEMENT_COARSE_FROM 4.1041 /* the h/D at which it is right */
#define ELEMENT_BEND 0.14671 /* how c changes with r, over what is recovered of h */
#define ELEMENT_BEND_FROM 0.24416 /* the recovered share at which it does not */

#endif
