/* vna.h - the virtual node algorithm as a time step sees it: each part of a cut element is a whole element again,
   with all of its mass and stiffness [Molino, Bao, Fedkiw 2004; without its limits on cuts: Sifakis, Der, Fedkiw
   2007].

   A baseline of the bench. The library finds which replicas there are and which virtual nodes they share: replicas
   share a node where their material is connected around it, in both methods. Include after gxfem.h or gxfem_solve.h. */
#ifndef GXFEM_BENCH_VNA_H
#define GXFEM_BENCH_VNA_H

#include <string.h>

/* Volume of the element with these gradients of shape functions, 1/m */
static double vna_volume(const double gradient[4][3]) {
    const double *a = gradient[1], *b = gradient[2], *c = gradient[3];
    const double det =
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    return 1 / (6 * (det < 0 ? -det : det));
}

/* Parts of elements (gx_body_model's) as replicas of whole elements; replicas: room for count. densities: by material,
 * kg/m3 */
static void vna_replicate(const gxs_element *parts, size_t count, const double *densities, gxs_element *replicas) {
    static const double mass[10] = {2, 1, 1, 1, 2, 1, 1, 2, 1, 2}; /* / 20 of the whole */
    size_t i, k;
    memcpy(replicas, parts, count * sizeof *replicas);
    for (i = 0; i < count; i++) {
        replicas[i].weight = vna_volume(parts[i].gradient);
        for (k = 0; k < 10; k++) replicas[i].mass[k] = densities[parts[i].material] * replicas[i].weight / 20 * mass[k];
    }
}

#endif
