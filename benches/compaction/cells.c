/* One sphere of a cubic packing under all-round pressure, by explicit finite elements: an eighth of it against the planes at which it meets its neighbours.
 *
 *     cells PACKING N Y SPEED DENSITY
 *
 * PACKING: sc, bcc, fcc, or pair for one contact alone. N: elements along an edge of each of the four blocks. Y: yield stress over E. SPEED: of the planes, over
 * sqrt(E/rho). Runs to the relative density DENSITY; of a pair, to h/R = 1 - DENSITY. Prints h/R, relative density, pressure over Y, nodes that the planes push.
 *
 * R = E = rho = 1, nu = 0.3. Hex8 with mean dilatation; multiplicative plasticity, radial return of the isochoric elastic left Cauchy-Green tensor (Simo 1988). Contact
 * without friction: a node that would pass a plane is put onto it. All neighbours are alike, so that a plane that moves is what a neighbour is.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NU 0.3
#define GP 0.57735026918962576

static int nodes, elements;
static double (*reference)[3], (*x)[3], (*v)[3], (*force)[3], *mass;
static int (*hexes)[8];

static void ball(const double u[3], double out[3])
{
    for (int a = 0; a < 3; a++) {
        const double p = u[(a + 1) % 3] * u[(a + 1) % 3], q = u[(a + 2) % 3] * u[(a + 2) % 3];
        out[a] = u[a] * sqrt(1 - p / 2 - q / 2 + p * q / 3);
    }
}

static void inner(const double u[3], double out[3])
{
    double round[3];
    ball(u, round);
    for (int a = 0; a < 3; a++) out[a] = 0.55 * (0.6 * u[a] + 0.4 * round[a]);
}

static int node(const double p[3])
{
    for (int i = 0; i < nodes; i++)
        if (fabs(reference[i][0] - p[0]) + fabs(reference[i][1] - p[1]) + fabs(reference[i][2] - p[2]) < 1e-7) return i;
    memcpy(reference[nodes], p, sizeof(double[3]));
    return nodes++;
}

static const int CORNER[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

static double det(const double m[3][3])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static double inverse(const double m[3][3], double out[3][3])
{
    const double d = det(m);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
            out[i][j] = (m[a][c] * m[b][e] - m[a][e] * m[b][c]) / d;
        }
    return d;
}

/* Gradients of the shape functions over reference coordinates, and volume, at a Gauss point; negative where the element is turned inside out. */
static double gradients(const int *hex, double (*at)[3], int gp, double out[8][3])
{
    double local[8][3], jacobian[3][3] = {{0}}, back[3][3];
    for (int a = 0; a < 8; a++) {
        double s[3], t[3];
        for (int k = 0; k < 3; k++) {
            t[k] = CORNER[a][k] ? 1 : -1;
            s[k] = 1 + t[k] * (CORNER[gp][k] ? GP : -GP);
        }
        local[a][0] = t[0] * s[1] * s[2] / 8;
        local[a][1] = t[1] * s[0] * s[2] / 8;
        local[a][2] = t[2] * s[0] * s[1] / 8;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) jacobian[i][k] += at[hex[a]][i] * local[a][k];
    }
    const double d = inverse(jacobian, back);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) out[a][i] = local[a][0] * back[0][i] + local[a][1] * back[1][i] + local[a][2] * back[2][i];
    return d;
}

/* Planes: normal, and distance over that of the nearest. */
static double planes[8][4];
static int count;

static void plane(double a, double b, double c, double distance)
{
    const double size = sqrt(a * a + b * b + c * c), row[4] = {a / size, b / size, c / size, distance};
    memcpy(planes[count++], row, sizeof row);
}

static void mesh(int n)
{
    const int most = 4 * (n + 1) * (n + 1) * (n + 1);
    reference = calloc(most, sizeof *reference);
    hexes = calloc(4 * n * n * n, sizeof *hexes);
    for (int block = 0; block < 4; block++)
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                for (int k = 0; k < n; k++, elements++) {
                    for (int a = 0; a < 8; a++) {
                        const double s[3] = {(double)(i + CORNER[a][0]) / n, (double)(j + CORNER[a][1]) / n, (double)(k + CORNER[a][2]) / n};
                        double p[3];
                        if (block == 3) {
                            inner(s, p);
                        } else {
                            /* From a face of the inner block to the surface. */
                            double u[3], in[3], out[3];
                            u[block] = 1;
                            u[(block + 1) % 3] = s[1];
                            u[(block + 2) % 3] = s[2];
                            inner(u, in);
                            ball(u, out);
                            for (int c = 0; c < 3; c++) p[c] = in[c] + s[0] * (out[c] - in[c]);
                        }
                        hexes[elements][a] = node(p);
                    }
                }
}

int main(int argc, char **argv)
{
    if (argc != 6) return fprintf(stderr, "cells PACKING N Y SPEED DENSITY\n"), 2;
    const char *packing = argv[1];
    const int n = atoi(argv[2]);
    const double yield = atof(argv[3]), speed = atof(argv[4]), end = atof(argv[5]);
    const double shear = 1 / (2 * (1 + NU)), bulk = 1 / (3 * (1 - 2 * NU)), wave = sqrt(bulk + 4 * shear / 3);
    double cell = 0; /* volume of the cell where the nearest planes are at a distance of 1 */
    if (!strcmp(packing, "pair")) {
        plane(0., 0., 1., 1.);
    } else if (!strcmp(packing, "sc")) {
        cell = 8;
        plane(1., 0., 0., 1.); plane(0., 1., 0., 1.); plane(0., 0., 1., 1.);
    } else if (!strcmp(packing, "bcc")) {
        cell = 32 / (3 * sqrt(3.));
        plane(1., 1., 1., 1.);
        plane(1., 0., 0., 2 / sqrt(3.)); plane(0., 1., 0., 2 / sqrt(3.)); plane(0., 0., 1., 2 / sqrt(3.));
    } else if (!strcmp(packing, "fcc")) {
        cell = 4 * sqrt(2.);
        plane(1., 1., 0., 1.); plane(0., 1., 1., 1.); plane(1., 0., 1., 1.);
        plane(1., 0., 0., sqrt(2.)); plane(0., 1., 0., sqrt(2.)); plane(0., 0., 1., sqrt(2.));
    } else {
        return fprintf(stderr, "cells: no packing %s\n", packing), 2;
    }
    mesh(n);
    x = calloc(nodes, sizeof *x), v = calloc(nodes, sizeof *v), force = calloc(nodes, sizeof *force), mass = calloc(nodes, sizeof *mass);
    double *area = calloc(nodes, sizeof *area);
    memcpy(x, reference, nodes * sizeof *x);
    double (*dn)[8][8][3] = calloc(elements, sizeof *dn), (*volume)[8] = calloc(elements, sizeof *volume), (*cp)[8][3][3] = calloc(elements, sizeof *cp);
    double whole = 0;
    for (int e = 0; e < elements; e++)
        for (int g = 0; g < 8; g++) {
            volume[e][g] = gradients(hexes[e], reference, g, dn[e][g]);
            if (volume[e][g] <= 0) return fprintf(stderr, "cells: element %d is inside out\n", e), 1;
            whole += volume[e][g];
            for (int a = 0; a < 8; a++) mass[hexes[e][a]] += volume[e][g] / 8;
            for (int k = 0; k < 3; k++) cp[e][g][k][k] = 1;
        }
    /* The polyhedron is made as large as the sphere: its faces lie within. */
    const double sphere = 4 * M_PI / 3, grown = cbrt(sphere / 8 / whole);
    const double stop = cell > 0 ? cbrt(sphere / (cell * end)) : end;
    double distance = 1.0, rate = 0, dt = 0, sums[3] = {0}, time = 0, next = 0.999;
    long steps = 0, summed = 0;
    printf("h,density,pressure,touching\n");
    for (; distance > stop; steps++) {
        if (steps % 50 == 0) {
            double smallest = 1;
            for (int e = 0; e < elements; e++) {
                double lengths = 0, g[8][3];
                for (int gp = 0; gp < 8; gp += 7) {
                    if (gradients(hexes[e], x, gp, g) <= 0) return fprintf(stderr, "cells: element %d turned inside out at h/R = %g\n", e, 1 - distance), 1;
                    for (int a = 0; a < 8; a++)
                        for (int i = 0; i < 3; i++) lengths = fmax(lengths, fabs(g[a][i]));
                }
                smallest = fmin(smallest, 1 / lengths);
            }
            dt = 0.25 * smallest / wave;
        }
        memset(force, 0, nodes * sizeof *force);
        for (int e = 0; e < elements; e++) {
            double f[8][3][3], j[8], now = 0, first = 0;
            for (int g = 0; g < 8; g++) {
                for (int i = 0; i < 3; i++)
                    for (int k = 0; k < 3; k++) {
                        double sum = 0;
                        for (int a = 0; a < 8; a++) sum += x[hexes[e][a]][i] * dn[e][g][a][k];
                        f[g][i][k] = sum;
                    }
                j[g] = det(f[g]);
                now += j[g] * volume[e][g];
                first += volume[e][g];
            }
            const double dilatation = now / first, mean = bulk * log(dilatation) / dilatation;
            for (int g = 0; g < 8; g++) {
                double back[3][3], half[3][3], b[3][3], sigma[3][3];
                inverse(f[g], back);
                const double scale = pow(j[g], -2.0 / 3.0);
                for (int i = 0; i < 3; i++)
                    for (int k = 0; k < 3; k++) half[i][k] = f[g][i][0] * cp[e][g][0][k] + f[g][i][1] * cp[e][g][1][k] + f[g][i][2] * cp[e][g][2][k];
                for (int i = 0; i < 3; i++)
                    for (int k = 0; k < 3; k++) b[i][k] = scale * (half[i][0] * f[g][k][0] + half[i][1] * f[g][k][1] + half[i][2] * f[g][k][2]);
                const double third = (b[0][0] + b[1][1] + b[2][2]) / 3;
                double size = 0;
                for (int i = 0; i < 3; i++)
                    for (int k = 0; k < 3; k++) {
                        sigma[i][k] = shear * (b[i][k] - (i == k ? third : 0));
                        size += sigma[i][k] * sigma[i][k];
                    }
                size = sqrt(size);
                if (size > sqrt(2.0 / 3.0) * yield) {
                    const double keep = sqrt(2.0 / 3.0) * yield / size;
                    for (int i = 0; i < 3; i++)
                        for (int k = 0; k < 3; k++) {
                            sigma[i][k] *= keep;
                            b[i][k] = sigma[i][k] / shear + (i == k ? third : 0);
                        }
                    const double unit = 1 / (cbrt(det(b)) * scale);
                    for (int i = 0; i < 3; i++)
                        for (int k = 0; k < 3; k++) half[i][k] = unit * (back[i][0] * b[0][k] + back[i][1] * b[1][k] + back[i][2] * b[2][k]);
                    for (int i = 0; i < 3; i++)
                        for (int k = 0; k < 3; k++) cp[e][g][i][k] = half[i][0] * back[k][0] + half[i][1] * back[k][1] + half[i][2] * back[k][2];
                }
                for (int i = 0; i < 3; i++)
                    for (int k = 0; k < 3; k++) sigma[i][k] = sigma[i][k] / j[g] + (i == k ? mean : 0);
                for (int a = 0; a < 8; a++) {
                    double grad[3];
                    for (int k = 0; k < 3; k++) grad[k] = dn[e][g][a][0] * back[0][k] + dn[e][g][a][1] * back[1][k] + dn[e][g][a][2] * back[2][k];
                    for (int i = 0; i < 3; i++)
                        force[hexes[e][a]][i] -= j[g] * volume[e][g] * (sigma[i][0] * grad[0] + sigma[i][1] * grad[1] + sigma[i][2] * grad[2]);
                }
            }
        }
        rate = speed * fmin(1.0, time * speed / 0.004);
        distance -= rate * dt;
        time += dt;
        double pushed = 0;
        int touching = 0;
        for (int i = 0; i < nodes; i++) {
            for (int k = 0; k < 3; k++) {
                v[i][k] = (1 - 0.02 * dt) * v[i][k] + dt * force[i][k] / mass[i];
                if (reference[i][k] < 1e-9) v[i][k] = 0;
            }
            for (int pass = 0; pass < 3; pass++)
                for (int p = 0; p < count; p++) {
                    const double place = planes[p][3] * distance / grown;
                    double over = -place;
                    for (int k = 0; k < 3; k++) over += planes[p][k] * (x[i][k] + dt * v[i][k]);
                    if (over <= 0) continue;
                    pushed += mass[i] * over / (dt * dt) * place;
                    touching++;
                    for (int k = 0; k < 3; k++)
                        if (reference[i][k] >= 1e-9) v[i][k] -= planes[p][k] * over / dt;
                }
            for (int k = 0; k < 3; k++) x[i][k] += dt * v[i][k];
        }
        /* Force times distance over three volumes of the cell; of a pair, the force on the plane over R^2. Lengths are `grown` times those of the mesh. */
        sums[0] += pushed, sums[1] += distance, sums[2] += touching, summed++;
        if (distance <= next || distance <= stop) {
            const double d = sums[1] / summed, moment = 8 * sums[0] / summed * grown * grown * grown;
            const double told = cell > 0 ? moment / (3 * cell * d * d * d) : moment / (2 * d);
            printf("%.6f,%.6f,%.6f,%.1f\n", 1 - d, cell > 0 ? sphere / (cell * d * d * d) : 0.0, told / yield, sums[2] / summed);
            fflush(stdout);
            memset(sums, 0, sizeof sums);
            summed = 0;
            next = distance - 0.001;
        }
    }
    fprintf(stderr, "%s: %d elements, %ld steps\n", packing, elements, steps);
    return 0;
}
