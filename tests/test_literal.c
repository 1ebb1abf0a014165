/* test_literal.c - the bench's literal Algorithm 1 and its virtual node algorithm: the same parts, copies and
   integrals as the library where cuts are solids in general position, and their own results elsewhere. */
#define _POSIX_C_SOURCE 199309L
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../gxfem_boolean.h"
#include "../gxfem_integrate.h"
#include "../bench/literal.h"
#include "../bench/vna.h"
#include "body.h"

static literal *literal_of(const workload *w) {
    literal_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.positions = w->positions;
    desc.node_count = w->node_count;
    desc.elements = w->elements;
    desc.element_count = w->element_count;
    desc.density = 1000;
    return literal_create(&desc);
}

static literal *literal_cut_by(const workload *w) {
    literal *l = literal_of(w);
    size_t i;
    for (i = 0; i < w->surface_count; i++) {
        const gx_surface solid = surface_of(&w->surfaces[i]);
        literal_cut(l, &solid, 1, NULL);
    }
    ck_assert_uint_eq(l->report.failures, 0);
    return l;
}

/* ---- comparison of models: parts and copies, whatever their order ---- */

/* Sorted by element (its gradients), then weight */
static int part_order(const void *a, const void *b) {
    const gxs_element *x = (const gxs_element *)a, *y = (const gxs_element *)b;
    const int order = memcmp(x->gradient[1], y->gradient[1], 9 * sizeof(double));
    return order ? order : (x->weight > y->weight) - (x->weight < y->weight);
}

/* In millionths of 1/m, so that the same element has the same bits, however it was computed */
static void round_gradients(gxs_element *parts, size_t count) {
    size_t i;
    int k;
    for (i = 0; i < count; i++)
        for (k = 0; k < 12; k++)
            parts[i].gradient[k / 3][k % 3] = floor(1e6 * parts[i].gradient[k / 3][k % 3] + 0.5) * 1e-6;
}

/* For each copy, the volume of the parts around it; sorted */
static double *supports_of(const gxs_model *m) {
    double *volume = (double *)calloc(m->copy_count + 1, sizeof *volume);
    size_t i;
    int k;
    for (i = 0; i < m->element_count; i++)
        for (k = 0; k < 4; k++) volume[m->elements[i].copy[k]] += m->elements[i].weight;
    qsort(volume, m->copy_count, sizeof *volume, ascending);
    return volume;
}

/* more: by what theirs may be larger. Algorithm 1 leaves a subdomain alone if a solid only takes a bit of it. */
static void compare_parts(const gxs_model *a, const gxs_model *b, double tolerance, double more) {
    gxs_element *x = (gxs_element *)malloc(a->element_count * sizeof *x),
                *y = (gxs_element *)malloc(b->element_count * sizeof *y);
    size_t i;
    int k;
    ck_assert_uint_eq(a->element_count, b->element_count);
    memcpy(x, a->elements, a->element_count * sizeof *x);
    memcpy(y, b->elements, b->element_count * sizeof *y);
    round_gradients(x, a->element_count);
    round_gradients(y, b->element_count);
    qsort(x, a->element_count, sizeof *x, part_order);
    qsort(y, b->element_count, sizeof *y, part_order);
    for (i = 0; i < a->element_count; i++) {
        const double whole = vna_volume((const double(*)[3])x[i].gradient);
        ck_assert_double_ge(y[i].weight, x[i].weight - tolerance * whole);
        ck_assert_double_le(y[i].weight, x[i].weight + tolerance * whole + more);
        for (k = 0; k < 10; k++) ck_assert_double_eq_tol(x[i].mass[k], y[i].mass[k], 1000 * (tolerance * whole + more));
    }
    free(x);
    free(y);
}

static void compare_copies(const gxs_model *a, const gxs_model *b, double tolerance, double more) {
    double *x = supports_of(a), *y = supports_of(b);
    size_t i;
    ck_assert_uint_eq(a->copy_count, b->copy_count);
    for (i = 0; i < a->copy_count; i++) ck_assert_double_eq_tol(x[i], y[i], tolerance + 32 * more);
    free(x);
    free(y);
}

/* The library's model, and that of Algorithm 1 for the same cuts */
static void compare_models(const workload *w, double tolerance, double more) {
    gx_body *body = cut_in_sequence(w);
    literal *l = literal_cut_by(w);
    gxs_model ours, theirs;
    ck_assert_int_eq(gx_body_model(body, &ours, NULL), GX_OK);
    literal_model(l, &theirs);
    compare_parts(&ours, &theirs, tolerance, more);
    compare_copies(&ours, &theirs, tolerance, more);
    literal_destroy(l);
    gx_body_destroy(body);
}

/* ---- Algorithm 1 ---- */

START_TEST(uncut_is_plain_finite_elements) {
    workload w = grid(2, 2, 1, 5);
    compare_models(&w, 1e-15, 0);
    wl_free(&w);
}
END_TEST

START_TEST(solids_in_general_position) {
    wl_frame frame = wl_rotated();
    workload w = wl_sticks(&frame);
    size_t all = w.surface_count;
    w.surface_count = 4; /* rounding lets surfaces cross themselves, and later solids cut slivers off them */
    compare_models(&w, 1e-13, 0);
    w.surface_count = all;
    wl_free(&w);
    w = wl_ring_cut(6);
    compare_models(&w, 1e-13, 0);
    wl_free(&w);
    w = wl_through(1e-4);
    compare_models(&w, 1e-13, 0);
    wl_free(&w);
}
END_TEST

START_TEST(random_slabs) {
    uint64_t seed;
    for (seed = 1; seed <= 12 / FEWER; seed++) {
        workload w = grid(2, 1, 1, 5);
        size_t i;
        random_seed(seed);
        for (i = 0; i < 3 * w.node_count; i++) w.positions[i] += random_real(-0.1, 0.1);
        for (i = 0; i < 3; i++) {
            add_random_plane(&w, 8);
            wl_solidify(&w.surfaces[i], 0.01);
        }
        compare_models(&w, 1e-12, 1e-4);
        wl_free(&w);
    }
}
END_TEST

/* Two slabs that overlap in the middle of the tetrahedron and go through it together */
static workload halves(void) {
    workload w = wl_tetrahedron(wl_corner_tetrahedron);
    add_box(&w, 1, -1, -1, 0.2, 0.22, 2, 0.21);
    add_box(&w, 1, 0.18, -1, 0.2, 2, 2, 0.21);
    return w;
}

START_TEST(partial_cuts_are_forgotten_as_published) {
    workload w = halves();
    gx_surface both[2];
    literal *apart = literal_cut_by(&w), *together = literal_of(&w);
    both[0] = surface_of(&w.surfaces[0]);
    both[1] = surface_of(&w.surfaces[1]);
    literal_cut(together, both, 1, NULL);
    literal_cut(together, both, 2, NULL);
    ck_assert_uint_eq(apart->element.count, 1);
    ck_assert_uint_eq(together->element.count, 2);
    ck_assert_uint_eq(together->copy_count, 8);
    literal_destroy(apart);
    literal_destroy(together);
    wl_free(&w);
}
END_TEST

START_TEST(new_copies_start_where_their_origin_is) {
    workload w = wl_through(1e-4);
    literal *l = literal_of(&w);
    const gx_surface solid = surface_of(&w.surfaces[0]);
    size_t i;
    int k;
    for (i = 0; i < 3 * l->copy_count; i++) {
        l->displacement[i] = (double)i;
        l->velocity[i] = -(double)i;
    }
    literal_cut(l, &solid, 1, NULL);
    ck_assert_uint_gt(l->copy_count, 4);
    for (i = 0; i < l->copy_count; i++)
        for (k = 0; k < 3; k++) {
            ck_assert_double_eq(l->displacement[3 * i + (size_t)k], 3.0 * l->copy_node[i] + k);
            ck_assert_double_eq(l->velocity[3 * i + (size_t)k], -3.0 * l->copy_node[i] - k);
        }
    literal_destroy(l);
    wl_free(&w);
}
END_TEST

START_TEST(distances) {
    workload w = wl_tetrahedron(wl_corner_tetrahedron);
    literal *l = literal_of(&w);
    const literal_domain *domain = &l->element.domains[0];
    const double inside[3] = {0.2, 0.2, 0.2}, below[3] = {0.2, 0.2, -0.5}, beside[3] = {0.5, -0.3, -0.4},
                 beyond[3] = {2, 0, 0}, on[3] = {0.25, 0.25, 0};
    ck_assert_double_eq(literal_distance(domain, inside), 0);
    ck_assert_double_eq(literal_distance(domain, on), 0);
    ck_assert_double_eq_tol(literal_distance(domain, below), 0.25, 1e-15);
    ck_assert_double_eq_tol(literal_distance(domain, beside), 0.25, 1e-15);
    ck_assert_double_eq_tol(literal_distance(domain, beyond), 1, 1e-15);
    literal_destroy(l);
    wl_free(&w);
}
END_TEST

/* ---- virtual nodes ---- */

START_TEST(replicas_are_whole_elements) {
    wl_frame frame = wl_rotated();
    workload w = wl_sticks(&frame);
    gx_body *body = cut_in_sequence(&w), *uncut = body_of(&w);
    const double density = 1000;
    gxs_model model;
    gxs_element *replicas;
    size_t i, k;
    ck_assert_int_eq(gx_body_model(uncut, &model, NULL), GX_OK);
    replicas = (gxs_element *)malloc(model.element_count * sizeof *replicas);
    vna_replicate(model.elements, model.element_count, &density, replicas);
    for (i = 0; i < model.element_count; i++) {
        ck_assert_double_eq_tol(replicas[i].weight, model.elements[i].weight, 1e-14);
        for (k = 0; k < 10; k++) ck_assert_double_eq_tol(replicas[i].mass[k], model.elements[i].mass[k], 1e-11);
    }
    free(replicas);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    replicas = (gxs_element *)malloc(model.element_count * sizeof *replicas);
    vna_replicate(model.elements, model.element_count, &density, replicas);
    for (i = 0; i < model.element_count; i++) {
        double mass = 0;
        for (k = 0; k < 10; k++) mass += replicas[i].mass[k] * (k == 0 || k == 4 || k == 7 || k == 9 ? 1 : 2);
        ck_assert_double_gt(replicas[i].weight, 1.0 / 7); /* 1/6 and 1/3 of a cube */
        ck_assert_double_eq_tol(mass, density * replicas[i].weight, 1e-10);
        ck_assert_mem_eq(replicas[i].copy, model.elements[i].copy, sizeof replicas[i].copy);
    }
    free(replicas);
    gx_body_destroy(body);
    gx_body_destroy(uncut);
    wl_free(&w);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("literal");
    TCase *algorithm = tcase_create("Algorithm 1"), *vna = tcase_create("virtual nodes");
    tcase_set_timeout(algorithm, 60);
    tcase_add_test(algorithm, uncut_is_plain_finite_elements);
    tcase_add_test(algorithm, solids_in_general_position);
    tcase_add_test(algorithm, random_slabs);
    tcase_add_test(algorithm, partial_cuts_are_forgotten_as_published);
    tcase_add_test(algorithm, new_copies_start_where_their_origin_is);
    tcase_add_test(algorithm, distances);
    tcase_add_test(vna, replicas_are_whole_elements);
    suite_add_tcase(suite, algorithm);
    suite_add_tcase(suite, vna);
    return run_suite(suite);
}
