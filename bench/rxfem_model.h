/* rxfem_model.h - a mesh cut by RXFEM (bench/rxfem.h) as a model for the library's time step, and RXFEM's own
   elastic derivatives.

   rx_model_create makes for each piece an element with the volume and mass that RXFEM's rule gives it. At a node a
   piece sees a value, u_i + sum of psi a (Eq. 10). Each different value is a copy of the model. So the step is over
   the same space with other integrals: the enrichment and the integration are compared, not the solver. A value with
   an enrichment of too small support (Eq. 22) follows an affine function through the corners of the best piece of
   its fragment: the one with most free corners, then the largest. (The paper says "as-rigid-as-possible", without a
   formula.)

   rx_elastic computes energy, forces and tangent stiffness of the paper's material, St. Venant-Kirchhoff, in RXFEM's
   own unknowns u and a (Eq. 12). It evaluates at each of the rule's points, or once for each piece, in which F is
   constant. The tangent is the exact one, not projected.

   Include after the implementations of gxfem_boolean.h, gxfem_integrate.h and gxfem_solve.h. Out of memory ends the
   program. */
#ifndef BENCH_RXFEM_MODEL_H
#define BENCH_RXFEM_MODEL_H

#include "rxfem.h"

/* The values of a node that pieces see: functions in rx_model.functions */
/* next: another one of the node, UINT32_MAX */
typedef struct rx_value {
    uint32_t node, next, first, count;
} rx_value;

typedef struct rx_model {
    gxs_model model; /* arrays below; materials and held are the caller's to set */
    rx_value *values;
    size_t value_count;
    /* enrichments of all values */
    uint32_t *functions;
    int *psi;
    size_t function_count;
    uint32_t *node_values; /* first value of each node */
    uint32_t *corners;     /* piece_count x 4: values */
    uint32_t *fragment;    /* value_count: representative of the values that pieces join */
    double *positions;     /* value_count x 3 */
    gxs_element *elements; /* piece_count */
    gxs_constraint *constraints;
    double *shares; /* of the enrichments (Eq. 27) */
} rx_model;

/* ---- values ---- */

static inline int rx_value_is(const rx_model *m, const rx_value *v, const uint32_t *functions, size_t count) {
    size_t i, j;
    if (v->count != count) return 0;
    for (i = 0; i < count; i++) {
        for (j = 0; j < count && m->functions[v->first + j] != functions[i]; j++) {}
        if (j == count) return 0;
    }
    return 1;
}

static inline uint32_t rx_find_value(rx_model *m, uint32_t node, const uint32_t *functions, const int *psi,
                                     size_t count) {
    uint32_t at;
    for (at = m->node_values[node]; at != UINT32_MAX; at = m->values[at].next)
        if (rx_value_is(m, &m->values[at], functions, count)) return at;
    if ((m->value_count & (m->value_count - 1)) == 0)
        m->values = (rx_value *)dense_memory(m->values, 2 * m->value_count + 1, sizeof *m->values);
    at = (uint32_t)m->value_count++;
    m->values[at].node = node;
    m->values[at].next = m->node_values[node];
    m->values[at].first = (uint32_t)m->function_count;
    m->values[at].count = (uint32_t)count;
    m->node_values[node] = at;
    if (count == 0) return at;
    m->functions = (uint32_t *)dense_memory(m->functions, m->function_count + count, sizeof *m->functions);
    m->psi = (int *)dense_memory(m->psi, m->function_count + count, sizeof *m->psi);
    memcpy(m->functions + m->function_count, functions, count * sizeof *functions);
    memcpy(m->psi + m->function_count, psi, count * sizeof *psi);
    m->function_count += count;
    return at;
}

static inline void rx_find_values(const rx_body *b, rx_model *m) {
    uint32_t functions[64];
    int psi[64], k;
    size_t i;
    memset(m->node_values, 255, b->node_count * sizeof *m->node_values);
    for (i = 0; i < b->piece_count; i++)
        for (k = 0; k < 4; k++) {
            const size_t count = rx_piece_functions(b, &b->pieces[i], k, functions, psi);
            m->corners[4 * i + (size_t)k] =
                rx_find_value(m, b->elements[4 * b->pieces[i].element + (uint32_t)k], functions, psi, count);
        }
}

static inline uint32_t rx_fragment_of(uint32_t *fragment, uint32_t value) {
    while (fragment[value] != value) value = fragment[value] = fragment[fragment[value]];
    return value;
}

static inline void rx_find_fragments(const rx_body *b, rx_model *m) {
    size_t i;
    uint32_t v;
    for (v = 0; v < m->value_count; v++) m->fragment[v] = v;
    for (i = 0; i < 4 * b->piece_count; i++)
        m->fragment[rx_fragment_of(m->fragment, m->corners[i])] = rx_fragment_of(m->fragment, m->corners[i - i % 4]);
    for (v = 0; v < m->value_count; v++) m->fragment[v] = rx_fragment_of(m->fragment, v);
}

/* ---- elements ---- */

/* A node whose mass the rule makes negative has no mass. */
static inline void rx_clear_negative(double mass[10]) {
    static const int row[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    int i, j;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4 && mass[row[i][i]] < 0; j++)
            if (j != i) mass[row[i][j]] = 0;
    for (i = 0; i < 4; i++) mass[row[i][i]] = fmax(0, mass[row[i][i]]);
}

/* The reference frame of a piece is that of gxi_part_mass with corner 0 as its origin, and its moments stand in the
   same order. Volumes that the rule makes negative are 0. */
static inline void rx_fill_element(const rx_body *b, const rx_model *m, size_t piece, double density, gxs_element *e) {
    const rx_piece *p = &b->pieces[piece];
    const double whole = rx_element_volume(b, p->element);
    double corners[12], gradients[12];
    gxi_moments2 moments;
    int k;
    memset(e, 0, sizeof *e);
    for (k = 0; k < 4; k++) {
        e->copy[k] = m->corners[4 * piece + (size_t)k];
        memcpy(corners + 3 * k, rx_corner(b, p->element, k), 3 * sizeof(double));
    }
    gxi_tet_gradients(corners, gradients, NULL);
    memcpy(e->gradient, gradients, sizeof gradients);
    moments.volume = p->moments[0];
    memcpy(moments.first, p->moments + 1, sizeof moments.first);
    memcpy(moments.second, p->moments + 4, sizeof moments.second);
    e->weight = fmax(0, 6 * whole * moments.volume);
    gxi_part_mass(&moments, 0, whole, density, e->mass);
    rx_clear_negative(e->mass);
}

/* ---- section 6, step 2 ---- */

/* Does one of the value's enrichments have next to no support? */
static inline int rx_is_constrained(const rx_model *m, uint32_t value) {
    const rx_value *v = &m->values[value];
    uint32_t i;
    for (i = v->first; i < v->first + v->count; i++)
        if (m->shares[m->functions[i]] < RX_SUPPORT) return 1;
    return 0;
}

/* The piece of the value's fragment with most free corners, then the largest; piece_count: no piece has any */
static inline size_t rx_leading_piece(const rx_body *b, const rx_model *m, uint32_t value) {
    size_t i, best = b->piece_count;
    int most = 0, k;
    for (i = 0; i < b->piece_count; i++) {
        int count = 0;
        if (m->fragment[m->corners[4 * i]] != m->fragment[value]) continue;
        for (k = 0; k < 4; k++) count += !rx_is_constrained(m, m->corners[4 * i + (size_t)k]);
        if (count < most || count == 0) continue;
        if (count == most && m->elements[i].weight <= m->elements[best].weight) continue;
        most = count;
        best = i;
    }
    return best;
}

/* Weights of the leader's free corners, with sum 1, whose mean is nearest to the node. Of several solutions, the
   shortest about the first corner */
static inline void rx_follow(const rx_body *b, const rx_model *m, uint32_t value, size_t leader, gxs_constraint *c) {
    const double *x = b->positions + 3 * (size_t)m->values[value].node;
    const double *first = NULL;
    double edges[9] = {0}, right[3], weights[3], rest = 1;
    uint32_t *masters = c->master;
    pinv inverse;
    int k, a, count = 0;
    memset(c, 0, sizeof *c);
    memset(&inverse, 0, sizeof inverse);
    c->copy = value;
    for (k = 0; k < 4; k++) {
        const uint32_t corner = m->corners[4 * leader + (size_t)k];
        const double *at = b->positions + 3 * (size_t)m->values[corner].node;
        if (rx_is_constrained(m, corner)) continue;
        masters[count++] = corner;
        if (!first) first = at;
        for (a = 0; a < 3 && count > 1; a++) edges[3 * a + count - 2] = at[a] - first[a];
    }
    for (a = 0; a < 3; a++) right[a] = x[a] - first[a];
    pinv_factor(&inverse, edges, 3, 3, RX_CUTOFF);
    pinv_solve(&inverse, right, weights);
    pinv_free(&inverse);
    for (k = 1; k < count; k++) {
        c->weight[k] = weights[k - 1];
        rest -= weights[k - 1];
    }
    c->weight[0] = rest;
    for (k = count; k < 4; k++) masters[k] = masters[0];
}

static inline void rx_constrain(const rx_body *b, rx_model *m) {
    uint32_t v;
    m->constraints = (gxs_constraint *)dense_memory(NULL, m->value_count, sizeof *m->constraints);
    for (v = 0; v < m->value_count; v++) {
        size_t leader;
        if (!rx_is_constrained(m, v)) continue;
        leader = rx_leading_piece(b, m, v);
        if (leader < b->piece_count) rx_follow(b, m, v, leader, &m->constraints[m->model.constraint_count++]);
    }
    m->model.constraints = m->constraints;
}

/* ---- */

static inline rx_model *rx_model_create(const rx_body *b, double density) {
    rx_model *m = (rx_model *)dense_memory(NULL, 1, sizeof *m);
    size_t i;
    memset(m, 0, sizeof *m);
    m->node_values = (uint32_t *)dense_memory(NULL, b->node_count, sizeof *m->node_values);
    m->corners = (uint32_t *)dense_memory(NULL, 4 * b->piece_count, sizeof *m->corners);
    m->elements = (gxs_element *)dense_memory(NULL, b->piece_count, sizeof *m->elements);
    m->shares = (double *)dense_memory(NULL, b->enrichment_count, sizeof *m->shares);
    rx_shares(b, m->shares);
    rx_find_values(b, m);
    m->fragment = (uint32_t *)dense_memory(NULL, m->value_count, sizeof *m->fragment);
    m->positions = (double *)dense_memory(NULL, 3 * m->value_count, sizeof *m->positions);
    rx_find_fragments(b, m);
    for (i = 0; i < b->piece_count; i++) rx_fill_element(b, m, i, density, &m->elements[i]);
    for (i = 0; i < m->value_count; i++)
        memcpy(m->positions + 3 * i, b->positions + 3 * (size_t)m->values[i].node, 3 * sizeof(double));
    m->model.copy_count = m->value_count;
    m->model.positions = m->positions;
    m->model.elements = m->elements;
    m->model.element_count = b->piece_count;
    rx_constrain(b, m);
    return m;
}

static inline void rx_model_destroy(rx_model *m) {
    if (!m) return;
    free(m->values);
    free(m->functions);
    free(m->psi);
    free(m->node_values);
    free(m->corners);
    free(m->fragment);
    free(m->positions);
    free(m->elements);
    free(m->constraints);
    free(m->shares);
    free(m);
}

/* Values from RXFEM's unknowns: u of the nodes, then a of the enrichments, x 3 */
static inline void rx_values_of(const rx_body *b, const rx_model *m, const double *unknowns, double *values) {
    size_t i, j;
    for (i = 0; i < m->value_count; i++) {
        const rx_value *v = &m->values[i];
        memcpy(values + 3 * i, unknowns + 3 * (size_t)v->node, 3 * sizeof(double));
        for (j = v->first; j < v->first + v->count; j++)
            dense_add(values + 3 * i, m->psi[j], unknowns + 3 * (b->node_count + m->functions[j]), 3);
    }
}

/* Adds a force on a value to the unknowns that make it up. */
static inline void rx_spread(const rx_body *b, const rx_model *m, uint32_t value, const double *force, double *forces) {
    const rx_value *v = &m->values[value];
    size_t j;
    dense_add(forces + 3 * (size_t)v->node, 1, force, 3);
    for (j = v->first; j < v->first + v->count; j++)
        dense_add(forces + 3 * (b->node_count + m->functions[j]), m->psi[j], force, 3);
}

/* F of a piece, by rows */
static inline void rx_deformation(const gxs_element *e, const double *values, double f[9]) {
    int r, s, k;
    for (r = 0; r < 3; r++)
        for (s = 0; s < 3; s++)
            for (f[3 * r + s] = r == s, k = 0; k < 4; k++)
                f[3 * r + s] += values[3 * (size_t)e->copy[k] + (size_t)r] * e->gradient[k][s];
}

/* Energy density, and the second Piola-Kirchhoff stress S = lambda tr(E) 1 + 2 mu E, E = (F^T F - 1) / 2 */
static inline double rx_stress(const double lame[2], const double f[9], double s[9]) {
    double trace, square = 0;
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            s[3 * i + j] = 0.5 * (f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j] - (i == j));
    trace = s[0] + s[4] + s[8];
    for (i = 0; i < 9; i++) {
        square += s[i] * s[i];
        s[i] = 2 * lame[1] * s[i] + (i % 4 == 0 ? lame[0] * trace : 0);
    }
    return 0.5 * lame[0] * trace * trace + lame[1] * square;
}

/* dP = dF S + F dS for dF = e_r g^T: dE = (a g^T + g a^T) / 2 with a the r-th row of F, tr dE = a . g */
static inline void rx_stress_change(const double lame[2], const double f[9], const double s[9], const double *g, int r,
                                    double change[9]) {
    const double *a = f + 3 * r, trace = dense_dot(a, g, 3);
    double fa[3], fg[3];
    int i, j;
    for (i = 0; i < 3; i++) {
        fa[i] = dense_dot(f + 3 * i, a, 3);
        fg[i] = dense_dot(f + 3 * i, g, 3);
    }
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            change[3 * i + j] = lame[0] * trace * f[3 * i + j] + lame[1] * (fa[i] * g[j] + fg[i] * a[j]) +
                                (i == r ? dense_dot(s + 3 * j, g, 3) : 0);
}

/* Adds weight times forces (12) and tangent stiffness (12 x 12) at one point; returns weight times the energy density.
 */
static inline double rx_add_point(const double lame[2], const gxs_element *e, const double f[9], double weight,
                                  double force[12], double stiffness[144]) {
    double s[9], change[9], stress[9];
    const double energy = rx_stress(lame, f, s);
    int k, r, j, q;
    for (k = 0; k < 9; k++)
        stress[k] = f[k - k % 3] * s[k % 3] + f[k - k % 3 + 1] * s[3 + k % 3] + f[k - k % 3 + 2] * s[6 + k % 3];
    for (k = 0; k < 12; k++) force[k] += weight * dense_dot(stress + 3 * (k % 3), e->gradient[k / 3], 3);
    for (k = 0; k < 4; k++)
        for (r = 0; r < 3; r++) {
            rx_stress_change(lame, f, s, e->gradient[k], r, change);
            for (j = 0; j < 4; j++)
                for (q = 0; q < 3; q++)
                    stiffness[12 * (3 * k + r) + 3 * j + q] += weight * dense_dot(change + 3 * q, e->gradient[j], 3);
        }
    return weight * energy;
}

/* Energy; forces (gradient, 3 (nodes + enrichments), set to 0 first) and, where stiffness is not NULL, each piece's
   tangent in its four values (piece_count x 144). published: at each of the rule's points in pieces of cut elements;
   else once for each piece. */
static inline double rx_elastic(const rx_body *b, const rx_model *m, double young, double poisson,
                                const double *unknowns, int published, double *forces, double *stiffness) {
    const double lame[2] = {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), 0.5 * young / (1 + poisson)};
    double *values = (double *)dense_memory(NULL, 3 * m->value_count, sizeof *values), weights[RX_POINTS], energy = 0;
    size_t i, j, k;
    rx_values_of(b, m, unknowns, values);
    memset(forces, 0, 3 * (b->node_count + b->enrichment_count) * sizeof *forces);
    for (i = 0; i < b->piece_count; i++) {
        const gxs_element *e = &m->elements[i];
        const uint32_t element = b->pieces[i].element;
        const int at_points = published && b->patch_first[element] < b->patch_first[element + 1];
        const size_t points = at_points ? b->rules->volume.point_count : 1;
        const double scale = 6 * rx_element_volume(b, element);
        double force[12] = {0}, tangent[144] = {0}, f[9];
        if (at_points)
            rx_weights(b->rules, b->pieces[i].moments, weights);
        else
            weights[0] = b->pieces[i].moments[0];
        for (j = 0; j < points; j++) {
            rx_deformation(e, values, f);
            energy += rx_add_point(lame, e, f, scale * weights[j], force, tangent);
        }
        for (k = 0; k < 4; k++) rx_spread(b, m, e->copy[k], force + 3 * k, forces);
        if (stiffness) memcpy(stiffness + 144 * i, tangent, sizeof tangent);
    }
    free(values);
    return energy;
}

#endif
