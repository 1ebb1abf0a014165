/* test_stack.c - the stack that calls take. Each piece of work runs in a thread that has 64 kB in all, with a page
   below that may not be touched, as in a fibre. The stack is painted before: how deep the paint is gone is how much the
   work took. A sanitizer's frames are larger, so there the stack is too, and nothing is measured.

   GXFEM_STACK=1 prints what each piece of work took. */
#define _DEFAULT_SOURCE
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "../gxfem_boolean.h"
#include "body.h"
#include "../bench/blade.h"
#include <pthread.h>
#include <stdio.h>
#include <sys/mman.h>

enum { STACK_PAGE = 4096, STACK_PAINT = 0xa5, STACK_ROOM = 65536 * (FEWER > 1 ? 64 : 1) };

typedef struct stack_work {
    void (*run)(void *context);
    void *context;
} stack_work;

static void *run_work(void *argument) {
    const stack_work *work = (const stack_work *)argument;
    work->run(work->context);
    return NULL;
}

/* Runs it on a stack of its own, of which it must leave some. */
static void check_stack(const char *name, void (*run)(void *), void *context) {
    const size_t size = STACK_ROOM + STACK_PAGE;
    stack_work work;
    pthread_attr_t attributes;
    pthread_t thread;
    unsigned char *memory;
    size_t low = STACK_PAGE;
    work.run = run;
    work.context = context;
    memory = (unsigned char *)mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ck_assert(memory != MAP_FAILED);
    memset(memory, STACK_PAINT, size);
    ck_assert_int_eq(mprotect(memory, STACK_PAGE, PROT_NONE), 0);
    ck_assert_int_eq(pthread_attr_init(&attributes), 0);
    ck_assert_int_eq(pthread_attr_setstack(&attributes, memory + STACK_PAGE, STACK_ROOM), 0);
    ck_assert_int_eq(pthread_create(&thread, &attributes, run_work, &work), 0);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    pthread_attr_destroy(&attributes);
    while (low < size && memory[low] == STACK_PAINT) low++;
    ck_assert_msg(low > STACK_PAGE, "%s", name);
    ck_assert_int_eq(munmap(memory, size), 0);
    if (getenv("GXFEM_STACK") != NULL) printf("%-40s %zu bytes of stack\n", name, size - low);
}

/* ---- bodies ---- */

static void must(gx_result result, const gx_failure *failure) {
    ck_assert_msg(result == GX_OK, "%s, field %s", gx_result_text(result), failure->field ? failure->field : "none");
}

static void step_body(gx_body *body, gx_step_desc desc) {
    gx_failure failure;
    desc.dt = 0.01;
    desc.gravity[2] = -9.81;
    must(gx_body_step(body, &desc, NULL, &failure), &failure);
}

typedef struct stack_case {
    const workload *w;
    gxs_material_kind kind;
    double affine_below;
    gxs_integrator integrator;
    int contact, quality; /* 1: with it */
} stack_case;

/* Quadratic, so that its Hessian is constant */
static double custom_energy(void *user, const double *F, double *stress, double *hessian) {
    double sum = 0;
    int i;
    (void)user;
    if (hessian != NULL) memset(hessian, 0, 81 * sizeof *hessian);
    for (i = 0; i < 9; i++) {
        const double g = F[i] - (i % 4 == 0 ? 1 : 0);
        sum += 0.5e6 * g * g;
        if (stress != NULL) stress[i] = 1e6 * g;
        if (hessian != NULL) hessian[10 * i] = 1e6;
    }
    return sum;
}

/* All that a host does with a body in a frame */
static void use_body(void *context) {
    const stack_case *c = (const stack_case *)context;
    gx_body_desc desc = desc_of(c->w);
    gx_material material;
    gx_step_desc step;
    gx_contact_desc contact;
    gx_failure failure;
    gx_skin skin;
    gx_hit hit;
    gx_body *body = NULL, *clone = NULL;
    const double from[3] = {0.4, 0.3, 9}, down[3] = {0.01, 0.02, -1}, inside[3] = {0.3, 0.4, 0.5};
    size_t i;
    memset(&material, 0, sizeof material);
    material.elastic.kind = c->kind;
    material.elastic.young = 1e5;
    material.elastic.poisson = 0.4;
    material.elastic.energy = c->kind == GXS_CUSTOM ? custom_energy : NULL;
    material.density = 1000;
    desc.materials = &material;
    desc.material_count = 1;
    desc.affine_below = c->affine_below;
    must(gx_body_create(&desc, &body, &failure), &failure);
    for (i = 0; i < c->w->surface_count; i++) cut_by(body, c->w, i, 1);
    memset(&contact, 0, sizeof contact);
    if (c->contact) must(gx_body_contact(body, &contact, &failure), &failure);
    memset(&step, 0, sizeof step);
    step.integrator = c->integrator;
    step.quality = c->quality ? 0.03 : 0;
    for (i = 0; i < 2; i++) step_body(body, step);
    must(gx_body_skin(body, NULL, &skin, &failure), &failure);
    must(gx_body_pick(body, from, down, &hit, &failure), &failure);
    must(gx_body_locate(body, inside, 1, &hit, &failure), &failure);
    must(gx_body_clone(body, &clone, &failure), &failure);
    step_body(clone, step);
    must(gx_body_restore(body, clone, &failure), &failure);
    gx_body_destroy(clone);
    gx_body_destroy(body);
}

static const struct {
    const char *name;
    gxs_material_kind kind;
    double affine_below;
    gxs_integrator integrator;
    int contact, quality;
} frames[] = {
    {"stable neo-Hookean", GXS_STABLE_NEO_HOOKEAN, 0, GXS_BDF1, 0, 0},
    {"stable neo-Hookean, contact", GXS_STABLE_NEO_HOOKEAN, 0, GXS_BDF2, 1, 0},
    {"stable neo-Hookean, quality", GXS_STABLE_NEO_HOOKEAN, 0, GXS_BDF1, 0, 1},
    {"stable neo-Hookean, explicit", GXS_STABLE_NEO_HOOKEAN, 0, GXS_EXPLICIT, 0, 0},
    {"stable neo-Hookean, midpoint", GXS_STABLE_NEO_HOOKEAN, 0, GXS_MIDPOINT, 0, 0},
    {"stable neo-Hookean, affine", GXS_STABLE_NEO_HOOKEAN, 3, GXS_BDF1, 0, 0},
    {"St. Venant-Kirchhoff, affine", GXS_ST_VENANT_KIRCHHOFF, 3, GXS_BDF1, 0, 0},
    {"St. Venant-Kirchhoff", GXS_ST_VENANT_KIRCHHOFF, 0, GXS_BDF1, 0, 0},
    {"fixed corotated", GXS_FIXED_COROTATED, 0, GXS_BDF2, 0, 0},
    {"linear", GXS_LINEAR, 0, GXS_BDF1, 0, 0},
    {"custom", GXS_CUSTOM, 0, GXS_BDF1, 0, 0},
    {"custom, affine", GXS_CUSTOM, 3, GXS_BDF1, 0, 0},
};
enum { FRAMES = sizeof frames / sizeof frames[0] };

/* Cut by planes in facets and across, and perhaps by a wave with its rim in the body */
static workload sliced(size_t n, int wave) {
    wl_frame middle = wl_axes();
    workload w = grid(n, n, n, 6);
    int k;
    for (k = 0; k < 3; k++) middle.origin[k] = 0.5 * (double)n + 0.1;
    add_axis_plane(&w, 0, 0.5 * (double)n);
    add_axis_plane(&w, 2, 0.3);
    if (wave) wl_add_wave(wl_add_surface(&w, 0), &middle, 12, 0.4 * (double)n);
    return w;
}

/* After the frames those of hard cases: slivers, cuts in facets, through nodes, an ulp beside them */
START_TEST(a_frame_of_a_body) {
    const int hard = _i - FRAMES;
    const char *name = hard < 0 ? frames[_i].name : NULL;
    size_t pieces;
    workload w = hard < 0 ? sliced(5, !frames[_i].contact) : wl_hard(hard, &name, &pieces);
    stack_case c;
    memset(&c, 0, sizeof c);
    c.w = &w;
    if (hard < 0) {
        c.kind = frames[_i].kind;
        c.affine_below = frames[_i].affine_below;
        c.integrator = frames[_i].integrator;
        c.contact = frames[_i].contact;
        c.quality = frames[_i].quality;
    }
    check_stack(name, use_body, &c);
    wl_free(&w);
}

/* ---- blades ---- */

static stage on_stage;

static void play(void *context) {
    stage_play(&on_stage, (const stage_scene *)context, 4, NULL);
    ck_assert(stage_ok(&on_stage));
    stage_close(&on_stage);
}

START_TEST(a_blade) {
    stage_scene scene = stage_scenes[_i];
    memset(&on_stage, 0, sizeof on_stage);
    check_stack(scene.name, play, &scene);
}

/* ---- Booleans ---- */

typedef struct boolean_case {
    const workload *w;
    int fine, mend;
} boolean_case;

static void evaluate(void *context) {
    const boolean_case *c = (const boolean_case *)context;
    gxb_boolean *b = NULL;
    gxb_boolean_result result;
    gxb_components components;
    gxb_defects defects;
    size_t i, k;
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_triangulation(b, GXB_MERGED, NULL), GX_OK);
    if (c->fine) ck_assert_int_eq(gxb_boolean_set_fine(b, 1, NULL), GX_OK);
    if (c->mend) ck_assert_int_eq(gxb_boolean_set_mend(b, 1, NULL), GX_OK);
    for (i = 0; i < c->w->surface_count; i++) {
        const wl_surface *s = &c->w->surfaces[i];
        gxb_operand operand;
        memset(&operand, 0, sizeof operand);
        operand.vertices = s->vertices;
        operand.vertex_count = s->vertex_count;
        operand.triangles = s->triangles;
        operand.triangle_count = s->triangle_count;
        operand.operation = i % 2 == 0 ? GXB_UNION : GXB_DIFFERENCE;
        ck_assert_int_eq(gxb_boolean_add(b, &operand, NULL), GX_OK);
    }
    for (k = 0; k < 2; k++) {
        ck_assert_int_eq(gxb_boolean_evaluate(b, &result, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_components(b, &components, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_defects(b, &defects, NULL), GX_OK);
    }
    ck_assert_uint_gt(result.triangle_count, 0);
    gxb_boolean_destroy(b);
}

/* Boxes that share planes, edges and corners, or miss them by a unit in the last place, turned out of the axes or not.
 */
static workload boxes(int turned) {
    static const wl_frame rotated = {{0.1, 0.2, 0.3},
                                     {0.75278436, 0.6578863, -0.0001333},
                                     {-0.59643, 0.682601, 0.4216083},
                                     {0.27760544822042, -0.31746769283768, 0.90672458835231}};
    workload w = wl_empty();
    int i, k;
    for (i = 0; i < 12; i++) {
        wl_frame f = turned ? rotated : wl_axes();
        const double ulp = i % 3 == 0 ? 1 : i % 3 == 1 ? 1 + ldexp(1, -52) : 1 - ldexp(1, -53);
        for (k = 0; k < 3; k++) f.origin[k] += (i >> k & 1) * 0.5 * f.u[k] + (i / 4) * 0.25 * f.v[k];
        wl_add_box(wl_add_surface(&w, 1), &f, 0.5 * ulp, 0.5, (i & 1 ? 0.25 : 0.5) * ulp);
    }
    return w;
}

START_TEST(a_boolean) {
    workload w = boxes(_i & 1);
    boolean_case c;
    memset(&c, 0, sizeof c);
    c.w = &w;
    c.fine = _i >> 1 & 1;
    c.mend = _i >> 2 & 1;
    check_stack("boxes", evaluate, &c);
    wl_free(&w);
}

/* ---- predicates of any doubles ---- */

static void ask(void *context) {
    double x[5][3];
    uint64_t i;
    (void)context;
    random_seed(5);
    for (i = 0; i < 500; i++) {
        int p, k, sign;
        for (p = 0; p < 5; p++)
            for (k = 0; k < 3; k++) {
                x[p][k] = i % 2 == 0 ? (double)random_below(3)
                                     : ldexp(random_real(-2, 2), i % 4 == 1 ? 0 : random_below(2000) - 1000);
                if (random_below(3) == 0) x[p][k] = x[random_below(5)][k];
            }
        sign = gxb_insphere(x[0], x[1], x[2], x[3], x[4]);
        ck_assert_int_eq(gxb_insphere(x[1], x[0], x[2], x[3], x[4]), -sign);
        sign = gxb_incircle(x[0], x[1], x[2], x[3]);
        ck_assert_int_eq(gxb_incircle(x[1], x[0], x[2], x[3]), -sign);
        sign = gxb_orient3d(x[0], x[1], x[2], x[3]);
        ck_assert_int_eq(gxb_orient3d(x[1], x[0], x[2], x[3]), -sign);
    }
}

START_TEST(predicates) { check_stack("predicates of any doubles", ask, NULL); }

/* ---- bodies of many parts ---- */

/* One sheet after the other, from one end to the other, so that what is left of edges, facets and elements is divided
   again and again; saved, loaded and cut again */
typedef struct stack_slices {
    int count, backwards;
} stack_slices;

static void slice(gx_body *body, int axis, double at) {
    workload w = wl_empty();
    add_axis_plane(&w, axis, at);
    cut_by(body, &w, 0, 1);
    wl_free(&w);
}

static void slice_and_save(void *context) {
    const stack_slices *c = (const stack_slices *)context;
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w), *loaded = NULL;
    size_t size = 0;
    void *bytes;
    int i;
    for (i = 0; i < c->count; i++) slice(body, 0, ((c->backwards ? c->count - 1 - i : i) + 0.5) / c->count);
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = malloc(size);
    ck_assert_ptr_nonnull(bytes);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &loaded, NULL), GX_OK);
    slice(body, 1, 0.5);
    slice(loaded, 1, 0.5);
    ck_assert(hash_of(body) == hash_of(loaded));
    free(bytes);
    gx_body_destroy(loaded);
    gx_body_destroy(body);
    wl_free(&w);
}

START_TEST(many_slices) {
    stack_slices c;
    c.count = (getenv("SLICES") ? atoi(getenv("SLICES")) : 200) / FEWER;
    c.backwards = _i;
    check_stack(_i == 0 ? "slices from left to right" : "slices from right to left", slice_and_save, &c);
}

int main(void) {
    Suite *suite = suite_create("stack");
    TCase *tcase = tcase_create("stack");
    tcase_set_timeout(tcase, 60);
    ADD_SOME(tcase, a_frame_of_a_body, FRAMES + WL_HARD);
    ADD_SOME(tcase, a_blade, STAGE_SCENES);
    ADD_SOME(tcase, a_boolean, 8);
    tcase_add_test(tcase, predicates);
    tcase_add_loop_test(tcase, many_slices, 0, 2);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
