/* test_threads_cuts.c - cuts of bodies on the host's threads give the bits that they give without: cells, volumes,
   masses and all else that hashes see, by any number of threads and in any order of tasks. Parts are small here, so
   that few triangles and points have many, and some parts have no room for what they find. Memory runs out at each
   allocation. */
#define GXP_SEARCH_PART  3u
#define GXP_PREPARE_PART 3u
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include "runner.h"

#include "pool.h"
#include "scarce.h"

enum { SCENES = 120, CUTS = 4 };

static gx_body *body_with(const workload *w, gx_jobs jobs, memory *m) {
    gx_body_desc desc = desc_of(w);
    gx_body *body = NULL;
    desc.jobs = jobs;
    if (m != NULL) desc.allocator = allocator_of(m);
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    return body;
}

static void check_equal(gx_body *a, gx_body *b, const gx_cut_report *r, const gx_cut_report *s) {
    const gx_view v = view_of(a), u = view_of(b);
    size_t c;
    ck_assert_uint_eq(hash_of(a), hash_of(b));
    ck_assert_uint_eq(gx_body_state_hash(a), gx_body_state_hash(b));
    ck_assert(memcmp(&r->min_link_ratio, &s->min_link_ratio, sizeof r->min_link_ratio) == 0);
    ck_assert(memcmp(&r->removed_volume, &s->removed_volume, sizeof r->removed_volume) == 0);
    ck_assert_uint_eq(v.cell_count, u.cell_count);
    ck_assert(memcmp(v.cell_volume, u.cell_volume, v.cell_count * sizeof *v.cell_volume) == 0);
    for (c = 0; c < a->cells.count; c++)
        ck_assert(memcmp(a->cells.data[c].mass, b->cells.data[c].mass, sizeof a->cells.data[c].mass) == 0);
    ck_assert_uint_eq(gxb_complex_point_count(a->complex), gxb_complex_point_count(b->complex));
    for (c = 0; c < gxb_complex_point_count(a->complex); c++)
        ck_assert(memcmp(&a->complex->store.points[c].ball, &b->complex->store.points[c].ball, sizeof(gxb_ball)) == 0);
}

/* The same cuts, one by one, in a body without threads and one with them */
static void check_cuts(const workload *w, gx_jobs jobs) {
    const gx_jobs none = {NULL, NULL};
    gx_body *a = body_with(w, none, NULL), *b = body_with(w, jobs, NULL);
    size_t i;
    for (i = 0; i < w->surface_count; i++) {
        const gx_cut_report r = cut_by(a, w, i, 1), s = cut_by(b, w, i, 1);
        check_equal(a, b, &r, &s);
    }
    gx_body_destroy(a);
    gx_body_destroy(b);
}

START_TEST(tasks_in_any_order) {
    uint64_t state = 5 + (uint64_t)_i;
    gx_jobs jobs;
    int i;
    jobs.parallel_for = shuffled_for;
    jobs.user = &state;
    for (i = 0; i < SCENES / 10 / FEWER; i++) {
        workload w = random_scene((uint64_t)(SCENES / 10 * _i + i), CUTS, 1);
        check_cuts(&w, jobs);
        wl_free(&w);
    }
}
END_TEST

/* A block of many elements, a wave of many triangles through it, a second one across, and a ball-like solid */
static workload large_scene(void) {
    workload w = grid(5, 5, 5, 6);
    wl_frame f = wl_rotated();
    int k;
    for (k = 0; k < 3; k++) f.origin[k] = 2.4 + 0.1 * k;
    wl_add_wave(wl_add_surface(&w, 0), &f, 30, 8);
    wl_add_wave(wl_add_surface(&w, 0), &f, 17, 9);
    add_box(&w, 1, 0.5, 0.5, 0.5, 2.5, 3.25, 4);
    add_plane(&w, f.origin, f.origin, 40); /* few triangles in many elements */
    return w;
}

START_TEST(tasks_on_threads) {
    static const size_t workers[] = {1, 2, 3, 8};
    static pool p;
    workload w = large_scene();
    gx_jobs jobs;
    pool_open(&p, workers[_i]);
    jobs.parallel_for = pool_for;
    jobs.user = &p;
    check_cuts(&w, jobs);
    ck_assert_uint_gt(p.calls, 4);
    pool_close(&p);
    wl_free(&w);
}
END_TEST

/* A cut that runs out of memory leaves the body as it was. */
START_TEST(memory_runs_out) {
    workload w = random_scene(40 + (uint64_t)_i, 0, 1);
    wl_frame f = wl_rotated();
    memory m = plenty();
    uint64_t state = 9;
    gx_surface surface;
    gx_cut_desc desc;
    gx_result result = GX_ERROR_MEMORY;
    gx_jobs jobs;
    gx_body *body;
    size_t n;
    uint64_t before;
    jobs.parallel_for = shuffled_for;
    jobs.user = &state;
    for (n = 0; n < 3; n++) f.origin[n] = 0.4;
    wl_add_wave(wl_add_surface(&w, 0), &f, 4, 1);
    surface = surface_of(&w.surfaces[0]);
    body = body_with(&w, jobs, &m);
    before = gx_body_state_hash(body);
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &surface;
    desc.surface_count = 1;
    for (n = 0; result != GX_OK; n++) {                 /* each n four times: arrays that grew ask no more */
        gxp_words *near = &body->scratch.near_elements; /* has nothing, as before the first search */
        gxp_release(&body->config.allocator, near->data, near->capacity * sizeof *near->data);
        memset(near, 0, sizeof *near);
        fail_from(&m, n / 4, 1);
        result = gx_body_cut(body, &desc, NULL, NULL);
        never_fail(&m);
        ck_assert(result == GX_OK || result == GX_ERROR_MEMORY);
        if (result != GX_OK) ck_assert_uint_eq(gx_body_state_hash(body), before);
    }
    gx_body_destroy(body);
    wl_free(&w);
    ck_assert(is_whole(&m));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("threads_cuts");
    TCase *tests = tcase_create("threads_cuts");
    tcase_set_timeout(tests, 300);
    tcase_add_loop_test(tests, tasks_in_any_order, 0, 10);
    tcase_add_loop_test(tests, tasks_on_threads, 0, 4);
    tcase_add_loop_test(tests, memory_runs_out, 0, 6);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
