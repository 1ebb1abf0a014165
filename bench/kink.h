/* kink.h - a trial: elements through which an interface of two materials goes, with a kink there.

   Such an element has two parts that share their four copies, so they have one displacement gradient, F. Here they have
   two. The displacement is what the copies give, plus a (phi - sum phi(x_i) N_i), where phi is the distance from the
   interface on the first part's side and 0 on the other's. So it is continuous inside the element, has a jump of its
   gradient along the interface's normal n, and is that of the copies at the nodes. With m = sum phi(x_i) grad N_i:

       F_1 = F + a (n - m)^T, F_2 = F - a m^T,      (P_1(F_1) - P_2(F_2)) n = 0

   The second equation gives a, for each element by itself. So there are no new unknowns. The element's energy is that
   of both parts at their gradients, a function of F: it goes to the solver as the caller's own material, GXS_CUSTOM.
   [Li, Lin, Wu 2003: immersed finite elements] Displacements of neighbours differ by as little as they bend at the
   interface: the elements do not conform there. Linear elasticity only, where a is linear in F. With materials that
   differ by much more than ten times, the equation for a is nearly singular in some elements: see docs/DECISIONS.md. */
#ifndef BENCH_KINK_H
#define BENCH_KINK_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The interface of an element: its facets' normals out of the material of lower index, and their middles, by area */
typedef struct kink_interface {
    double normal[3], middle[3], area;
} kink_interface;

typedef struct kink {
    double hessian[81]; /* of the energy density, Pa */
} kink;

/* A model with kinks */
typedef struct kinked {
    gxs_element *elements;
    gxs_material *materials;
    kink *kinks;
    size_t kink_count;
} kinked;

static inline double kink_energy(void *user, const double *deformation, double *stress, double *hessian) {
    const kink *k = (const kink *)user;
    double g[9], p[9], energy = 0;
    int i, j;
    for (i = 0; i < 9; i++) g[i] = deformation[i] - (i % 4 == 0);
    for (i = 0; i < 9; i++) {
        for (j = 0, p[i] = 0; j < 9; j++) p[i] += k->hessian[9 * i + j] * g[j];
        energy += 0.5 * p[i] * g[i];
    }
    if (stress != NULL) memcpy(stress, p, sizeof p);
    if (hessian != NULL) memcpy(hessian, k->hessian, sizeof k->hessian);
    return energy;
}

/* c: dP_i/dF_j of a linear material */
static inline void kink_stiffness(const gxs_material *m, double c[81]) {
    const double mu = m->young / (2 * (1 + m->poisson));
    const double lambda = m->young * m->poisson / ((1 + m->poisson) * (1 - 2 * m->poisson));
    int e;
    for (e = 0; e < 81; e++) {
        const int i = e / 27, j = e / 9 % 3, k = e / 3 % 3, l = e % 3;
        c[e] = lambda * (i == j && k == l) + mu * ((i == k && j == l) + (i == l && j == k));
    }
}

/* Adds a facet to its element's interface. sign: -1 where its normal points into the material of lower index */
static inline void kink_add_facet(gx_body *body, uint32_t element, uint32_t facet, double sign, kink_interface *of) {
    gxb_complex *cx = body->complex;
    uint32_t first, count, i;
    double x[12], corner[3][3], middle[3] = {0, 0, 0}, area[3] = {0, 0, 0}, size;
    int k, n;
    expect(gxb_facet_resolve_edges(cx, facet, &first, &count) == GX_OK, "no facet");
    gxp_element_positions(body, element, x);
    for (i = 0; i < count; i++) {
        double lambda[4], *p = corner[i < 2 ? i : 2];
        gxb_complex_barycentric(cx, gxb_complex_edge_start(cx, gxp_item(cx, first + i)), element, lambda);
        for (k = 0; k < 3; k++) {
            for (n = 0, p[k] = 0; n < 4; n++) p[k] += lambda[n] * x[3 * n + k];
            middle[k] += p[k] / count;
        }
        for (k = 0; k < 3 && i >= 2; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            area[k] += 0.5 * ((corner[1][a] - corner[0][a]) * (p[b] - corner[0][b]) -
                              (corner[1][b] - corner[0][b]) * (p[a] - corner[0][a]));
        }
        if (i >= 2) memcpy(corner[1], p, sizeof corner[1]);
    }
    size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    for (k = 0; k < 3; k++) {
        of->normal[k] += sign * area[k];
        of->middle[k] += size * middle[k];
    }
    of->area += size;
}

/* The interfaces of all elements, by element */
static inline kink_interface *kink_find(gx_body *body) {
    kink_interface *found = (kink_interface *)memory(body->mesh.element_count, sizeof *found);
    gxb_complex *cx = body->complex;
    uint32_t leaf, first, count, i;
    memset(found, 0, body->mesh.element_count * sizeof *found);
    for (leaf = 0; leaf < body->leaves.count; leaf++) {
        const uint32_t element = gxb_complex_leaf(cx, leaf)->element;
        if (!gxp_is_kept(body, leaf) || gxb_complex_leaf(cx, leaf)->facet_count == 0) continue;
        expect(gxb_leaf_resolve_facets(cx, leaf, &first, &count) == GX_OK, "no facets");
        for (i = 0; i < count; i++) {
            const uint32_t facet = gxp_item(cx, first + i);
            const gxb_facet *f = gxb_complex_facet(cx, facet);
            const uint32_t other = f->leaf[f->leaf[0] == leaf];
            if (f->face != GXB_NONE || !gxp_is_link(body, facet)) continue;
            if (gxp_leaf_material(body, leaf) < gxp_leaf_material(body, other))
                kink_add_facet(body, element, facet, f->leaf[0] == leaf ? -1 : 1, &found[element]);
        }
    }
    return found;
}

/* a = jump F, where the stress's jump K a + (c[0] - c[1]) n F vanishes. along: n - m and -m of the two parts */
static inline void kink_jump(double c[2][81], const double n[3], double along[2][3], double jump[27]) {
    double k[9], inverse[9], of[27], det;
    int e, p, s;
    for (e = 0; e < 27; e++)
        for (p = 0, of[e] = 0; p < 3; p++)
            of[e] += n[p] * (c[0][9 * (3 * (e / 9) + p) + e % 9] - c[1][9 * (3 * (e / 9) + p) + e % 9]);
    for (e = 0; e < 9; e++)
        for (p = 0, k[e] = 0; p < 3; p++)
            for (s = 0; s < 3; s++) {
                const int entry = 9 * (3 * (e / 3) + p) + 3 * (e % 3) + s;
                k[e] += n[p] * (c[0][entry] * along[0][s] - c[1][entry] * along[1][s]);
            }
    for (e = 0; e < 9; e++) {
        const int i = e / 3, j = e % 3, r = 3 * ((j + 1) % 3), t = 3 * ((j + 2) % 3);
        inverse[e] = k[r + (i + 1) % 3] * k[t + (i + 2) % 3] - k[r + (i + 2) % 3] * k[t + (i + 1) % 3];
    }
    det = k[0] * inverse[0] + k[1] * inverse[3] + k[2] * inverse[6];
    for (e = 0; e < 27; e++)
        for (p = 0, jump[e] = 0; p < 3; p++) jump[e] -= inverse[3 * (e / 9) + p] / det * of[9 * p + e % 9];
}

/* The energy's Hessian: of the parts' materials at the gradients that follow from F */
static inline void kink_make(gx_body *body, const gxs_element parts[2], const gxs_material *materials,
                             const kink_interface *of, kink *out) {
    const double size =
        sqrt(of->normal[0] * of->normal[0] + of->normal[1] * of->normal[1] + of->normal[2] * of->normal[2]);
    const int low = parts[0].material < parts[1].material ? 0 : 1; /* the part out of which the normal points */
    double x[12], n[3], along[2][3], c[2][81], jump[27];
    int i, j, k, p, q;
    gxp_element_positions(body, parts[0].group, x);
    for (k = 0; k < 3; k++) n[k] = (low == 0 ? -1 : 1) * of->normal[k] / size; /* into the first part */
    for (k = 0; k < 3; k++) {
        along[0][k] = n[k];
        along[1][k] = 0;
    }
    for (i = 0; i < 4; i++) {
        double distance = 0;
        for (k = 0; k < 3; k++) distance += n[k] * (x[3 * i + k] - of->middle[k] / of->area);
        for (k = 0; k < 6 && distance > 0; k++) along[k / 3][k % 3] -= distance * parts[0].gradient[i][k % 3];
    }
    for (p = 0; p < 2; p++) kink_stiffness(&materials[parts[p].material], c[p]);
    kink_jump(c, n, along, jump);
    memset(out, 0, sizeof *out);
    for (p = 0; p < 2; p++) {
        const double share = parts[p].weight / (parts[0].weight + parts[1].weight);
        double own[81], half[81]; /* the part's gradient by F; its stress by F */
        for (i = 0; i < 81; i++) own[i] = (i / 9 == i % 9) + jump[9 * (i / 27) + i % 9] * along[p][i / 9 % 3];
        for (i = 0; i < 81; i++)
            for (q = 0, half[i] = 0; q < 9; q++) half[i] += c[p][9 * (i / 9) + q] * own[9 * q + i % 9];
        for (i = 0; i < 9; i++)
            for (j = 0; j < 9; j++)
                for (q = 0; q < 9; q++) out->hessian[9 * i + j] += share * own[9 * q + i] * half[9 * q + j];
    }
}

/* Is element i of the model the first of just two parts of its element, which differ in material only? */
static inline int kink_is_pair(const gxs_model *model, size_t i) {
    const gxs_element *e = model->elements + i;
    const size_t rest = model->element_count - i;
    return rest > 1 && e[0].group == e[1].group && memcmp(e[0].copy, e[1].copy, sizeof e->copy) == 0 &&
           e[0].material != e[1].material && (i == 0 || e[-1].group != e->group) &&
           (rest < 3 || e[2].group != e->group);
}

/* Gives the body's model kinks where its interfaces are flat enough to have a normal: where that of their sum is at
   least half their area. */
static inline void kink_add(kinked *k, gx_body *body, gxs_model *model) {
    kink_interface *of = kink_find(body);
    size_t i, n = 0;
    int m;
    k->elements = (gxs_element *)memory(model->element_count, sizeof *k->elements);
    k->kinks = (kink *)memory(model->element_count, sizeof *k->kinks);
    k->materials = (gxs_material *)memory(model->element_count + model->material_count, sizeof *k->materials);
    k->kink_count = 0;
    memcpy(k->materials, model->materials, model->material_count * sizeof *k->materials);
    for (i = 0; i < model->element_count; i++, n++) {
        const gxs_element *e = model->elements + i;
        const kink_interface *found = &of[e->group];
        const double square = found->normal[0] * found->normal[0] + found->normal[1] * found->normal[1] +
                              found->normal[2] * found->normal[2];
        gxs_element *own = &k->elements[n];
        gxs_material *material = &k->materials[model->material_count + k->kink_count];
        *own = *e;
        if (!kink_is_pair(model, i) || 4 * square < found->area * found->area) continue;
        kink_make(body, e, model->materials, found, &k->kinks[k->kink_count]);
        *material = model->materials[e->material];
        material->kind = GXS_CUSTOM;
        material->energy = kink_energy;
        material->user = &k->kinks[k->kink_count];
        own->material = (uint32_t)(model->material_count + k->kink_count++);
        own->weight += e[1].weight;
        for (m = 0; m < 10; m++) own->mass[m] += e[1].mass[m];
        i++;
    }
    model->elements = k->elements;
    model->element_count = n;
    model->materials = k->materials;
    model->material_count += k->kink_count;
    free(of);
}

static inline void kink_free(kinked *k) {
    free(k->elements);
    free(k->materials);
    free(k->kinks);
}

#endif
