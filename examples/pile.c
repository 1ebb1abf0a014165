/* pile: a ball is diced into 60 pieces by planes that lean, falls on the ground and becomes a pile.

   The pieces touch from the very frame of the cut on: their faces have no gap. Nothing slows them down but friction;
   what no longer moves falls asleep. --mesh dices another shape, what was along its y upright. */
#include "scene.h"

#include "touching.h"

enum { MOST_PLANES = 16 };

/* Planes across each axis, evenly through the box around the body; every other one leans to the other side. */
static size_t plan_planes(scene *s, const uint32_t parts[3], double lean, scene_sheet planes[MOST_PLANES]) {
    double low[3], high[3];
    size_t count = 0;
    uint32_t axis, i;
    scene_bounds(s, low, high);
    for (axis = 0; axis < 3; axis++)
        for (i = 1; i < parts[axis]; i++) {
            const uint32_t j = (axis + 1) % 3, k = (axis + 2) % 3;
            const double tilt = i % 2 ? lean : -lean;
            double corner[3], u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
            corner[axis] = low[axis] + (high[axis] - low[axis]) * (i / (double)parts[axis] + 0.0131 - 1.5 * tilt);
            corner[j] = 2.0 * low[j] - high[j];
            corner[k] = 2.0 * low[k] - high[k];
            u[axis] = 3.0 * tilt * (high[axis] - low[axis]);
            u[j] = 3.0 * (high[j] - low[j]);
            v[k] = 3.0 * (high[k] - low[k]);
            planes[count++] = scene_flat_sheet(s, corner, u, v, 1);
        }
    return count;
}

/* All planes at once */
static void dice(scene *s, const uint32_t parts[3]) {
    scene_sheet planes[MOST_PLANES];
    gx_surface surfaces[MOST_PLANES];
    const size_t count = plan_planes(s, parts, 0.02, planes);
    size_t i;
    memset(surfaces, 0, sizeof surfaces);
    for (i = 0; i < count; i++) {
        surfaces[i].vertices = planes[i].vertices;
        surfaces[i].vertex_count = 4;
        surfaces[i].triangles = planes[i].triangles;
        surfaces[i].triangle_count = 2;
    }
    scene_cut(s, surfaces, count);
    for (i = 0; i < count; i++) scene_drop_sheet(&planes[i]);
}

/* What was along y is upright then. */
static void stand(scene *s) {
    size_t i;
    for (i = 0; i < s->mesh.node_count; i++) {
        double *x = s->mesh.positions + 3 * i;
        const double y = x[1];
        x[1] = -x[2];
        x[2] = y;
    }
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "pile",
                             .about = "A ball is diced, falls on the ground and becomes a pile.",
                             .mesh = "ball:0.06,0.014",
                             .small_mesh = "ball:0.06,0.024",
                             .any_mesh = 1,
                             .frames = 600,
                             .small_frames = 480,
                             .least_frames = 60};
    const uint32_t parts[3] = {3, 4, 5}, small_parts[3] = {2, 2, 3};
    const size_t expected = 60, small_expected = 12;
    double low[3], high[3];
    size_t pieces;
    scene s;
    touching on;
    scene_open(&s, &desc, argc, argv);
    stand(&s);
    scene_scale(&s, 10.0, 10.0, 10.0);
    s.body_desc.poisson = 0.3;
    s.step.dt = s.small ? 1.0 / 60.0 : 1.0 / 120.0;
    s.step.sleep_speed = 0.05;
    scene_make(&s);
    scene_bounds(&s, low, high);
    touching_begin(&s, &on, 0.6, low[2] - 0.02 * (high[2] - low[2]));
    dice(&s, s.small ? small_parts : parts);
    while (s.frame < s.frames) {
        scene_step(&s);
        touching_look(&s, &on);
    }
    pieces = scene_fragments_above(&s, 1e-9);
    scene_check(&s, pieces == (s.small ? small_expected : expected), "pieces: %lu (%lu)", (unsigned long)pieces,
                (unsigned long)(s.small ? small_expected : expected));
    touching_check_depths(&s, &on, 0.3, 0.1);
    touching_check_above(&s, &on);
    scene_say(&s, "the last step: %s", s.report.stop == GXS_STOP_ASLEEP ? "asleep" : "awake");
    scene_check_body(&s);
    return scene_close(&s);
}
