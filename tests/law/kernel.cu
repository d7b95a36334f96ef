// The headers in device code. What nvcc brings by itself is declared by hand, so that clang compiles it without CUDA: the marks, and the mathematics that the update calls.
#include <stddef.h>

#define __CUDACC__
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))
#define __global__ __attribute__((global))

extern "C" {
__device__ double exp(double);
__device__ double log(double);
__device__ double sqrt(double);
__device__ double fabs(double);
__device__ double sin(double);
__device__ double cos(double);
__device__ float expf(float);
__device__ float logf(float);
__device__ float sqrtf(float);
__device__ float fabsf(float);
__device__ float sinf(float);
__device__ float cosf(float);
__device__ void *memcpy(void *, const void *, size_t);
__device__ void *memset(void *, int, size_t);
}

#include "asperity_contact3d.h"

extern "C" __global__ void move_contacts(
    const asperity_table *table, asperity_state *states, const asperity_real *h, const asperity_real (*d)[2], asperity_response *out, asperity_tangent *tangents) {
    asperity_update(table, 1, 1, states, h[0], d[0], states, out, NULL);
    asperity_update(table, 1, 1, states + 1, h[1], d[1], states + 1, out + 1, tangents);
}

extern "C" __global__ void collide_spheres(
    const asperity_law3d *law, const asperity_body *bodies, const asperity_wall *wall, asperity_contact *contacts, asperity_forces *out) {
    asperity_spheres(law, bodies, bodies + 1, asperity_real(1e-3), contacts, contacts, out);
    asperity_sphere_wall(law, bodies, wall, asperity_real(1e-3), contacts + 1, contacts + 1, out + 1);
    asperity_exchange(contacts);
}
