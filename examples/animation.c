/* animation: the README's animated picture. A bunny of jelly hangs by its ears and swings; curved sheets cut it from
   below, and slice after slice falls.

   Nothing holds back what has been cut off: it falls out of the picture. What is left springs up. */
#include "scene.h"

enum { CUTS = 5, COLUMNS = 40, ROWS = 12 };

static const double turn = 6.283185307179586;
static const double held = 0.168; /* m: what is above it is held */
static const double swing = 0.12; /* m/s, along x */
static const double reach = 0.11; /* of the sheets from the middle, m */
static const double middle[2] = {-0.012, 0.006};

/* A sheet that waves about a height: how far it tilts along x and z, how high its waves are along both, m */
typedef struct slice {
    double height, tilt[2], wave[2], length[2], from; /* from: share of the run at which it enters */
} slice;

static const slice slices[CUTS] = {{0.050, {0.006, 0.010}, {0.003, 0.003}, {0.06, 0.05}, 0.12},
                                   {0.068, {-0.012, 0.012}, {0.005, 0.003}, {0.07, 0.06}, 0.25},
                                   {0.086, {0.014, -0.008}, {0.005, 0.004}, {0.06, 0.07}, 0.38},
                                   {0.106, {-0.012, -0.012}, {0.004, 0.004}, {0.05, 0.06}, 0.51},
                                   {0.128, {0.010, 0.006}, {0.003, 0.002}, {0.05, 0.05}, 0.64}};

/* a: along x, as the sheet advances; b: along z */
static void slice_point(const void *user, double a, double b, double *x) {
    const slice *s = (const slice *)user;
    const double u = 2.0 * a - 1.0, v = 2.0 * b - 1.0;
    x[0] = middle[0] + reach * u;
    x[2] = middle[1] + reach * v;
    x[1] = s->height + s->tilt[0] * u + s->tilt[1] * v + s->wave[0] * sin(turn * reach * u / s->length[0]) +
           s->wave[1] * sin(turn * reach * v / s->length[1]);
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "animation",
                             .about = "A bunny hangs by its ears and is cut into slices, which fall.",
                             .mesh = "bunny",
                             .small_mesh = "bunny:0.016",
                             .any_mesh = 1,
                             .frames = 120,
                             .small_frames = 60,
                             .least_frames = 60};
    scene s;
    scene_sheet sheets[CUTS];
    size_t copy;
    int i;
    scene_open(&s, &desc, argc, argv);
    s.body_desc.young = 2e4;
    s.step.dt = 0.01;
    s.step.integrator = GXS_BDF2;
    s.step.newton_iterations = 2;
    s.step.gravity[1] = s.step.gravity[2];
    s.step.gravity[2] = 0.0;
    scene_make(&s);
    scene_hold(&s, 1, 1, held);
    scene_settle(&s, 1e-4);
    for (copy = 0; copy < s.view.copy_count; copy++) s.view.velocity[3 * copy] = s.view.copy_held[copy] ? 0.0 : swing;
    for (i = 0; i < CUTS; i++) sheets[i] = scene_make_sheet(&s, COLUMNS, ROWS, slice_point, &slices[i]);
    for (; s.frame < s.frames; scene_step(&s))
        for (i = 0; i < CUTS; i++) scene_advance(&s, &sheets[i], slices[i].from, slices[i].from + 0.1);
    scene_check(&s, s.view.fragment_count > CUTS, "fragments: %lu (at least %d)", (unsigned long)s.view.fragment_count,
                CUTS + 1);
    scene_check_body(&s);
    for (i = 0; i < CUTS; i++) scene_drop_sheet(&sheets[i]);
    return scene_close(&s);
}
