/* swiss_cheese: one tetrahedron is cut by waves and planes in several directions (GXFEM, "Swiss cheese tetrahedron",
   Fig. 6).

   Whatever the surfaces do inside it, the element has four nodes, and each piece takes four copies of them. Without
   gravity; once all is cut, each piece is set off outwards, and shows itself. The surfaces are in cheese.h, since
   tests/test_scenes.c holds the counts of --small against the exact oracle. */
#include "scene.h"
#include "cheese.h"

/* Cuts by the surfaces from `first` to before `end`. */
static void cut(scene *s, const cheese_surface *surfaces, uint32_t first, uint32_t end) {
    gx_surface surface;
    memset(&surface, 0, sizeof surface);
    for (; first < end; first++) {
        surface.vertices = surfaces[first].vertices;
        surface.vertex_count = surfaces[first].vertex_count;
        surface.triangles = surfaces[first].triangles;
        surface.triangle_count = surfaces[first].triangle_count;
        scene_cut(s, &surface, 1);
    }
}

/* Sets every fragment off from the middle of the body, its centre at 1 m/s for each metre of distance. */
static void burst(scene *s, double middle[3]) {
    uint32_t *fragment;
    size_t copy, i;
    scene_look(s);
    fragment = scene_copy_fragments(s);
    for (copy = 0; copy < s->view.copy_count; copy++)
        for (i = 0; i < 3; i++)
            s->view.velocity[3 * copy + i] = s->view.fragment_center[3 * (size_t)fragment[copy] + i] - middle[i];
    free(fragment);
}

/* How far the centre of a fragment is, after so many seconds of flight, from where it should be; m */
static double astray(scene *s, const double middle[3], double seconds) {
    double worst = 0.0;
    uint32_t f, i;
    for (f = 0; f < s->view.fragment_count; f++) {
        const gx_motion motion = scene_motion(s, f);
        const double *from = s->view.fragment_center + 3 * (size_t)f;
        for (i = 0; i < 3; i++)
            worst = fmax(worst, fabs(motion.center[i] - (from[i] + seconds * (from[i] - middle[i]))));
    }
    return worst;
}

int main(int argc, char **argv) {
    const scene_desc desc = {
        .name = "swiss_cheese",
        .about = "One tetrahedron is cut by waves and planes in several directions, and its pieces fly apart.",
        .mesh = "tet",
        .frames = 90,
        .small_frames = 20};
    cheese_surface surfaces[CHEESE_SURFACES];
    double middle[3], off, least = HUGE_VAL;
    uint32_t done = 0, flight = 0;
    size_t c;
    scene s;
    scene_open(&s, &desc, argc, argv);
    scene_scale(&s, CHEESE_EDGE, CHEESE_EDGE, CHEESE_EDGE);
    s.step.gravity[2] = 0.0;
    scene_make(&s);
    memcpy(middle, s.view.fragment_center, sizeof middle);
    cheese_fill(surfaces, s.small ? CHEESE_COARSE : CHEESE_FINE);
    for (; s.frame < s.frames; scene_step(&s)) {
        const uint32_t due = scene_due(&s, 0.1, 0.5, CHEESE_SURFACES);
        cut(&s, surfaces, done, due);
        done = due;
        if (done == CHEESE_SURFACES && flight++ == 0) burst(&s, middle);
    }
    if (s.small) {
        scene_check(&s, s.view.cell_count == CHEESE_CELLS, "cells: %lu (%d, by the exact oracle)",
                    (unsigned long)s.view.cell_count, CHEESE_CELLS);
        scene_check(&s, s.view.copy_count == CHEESE_COPIES, "copies: %lu (%d, by the exact oracle)",
                    (unsigned long)s.view.copy_count, CHEESE_COPIES);
    } else
        scene_say(&s, "cells: %lu, copies: %lu", (unsigned long)s.view.cell_count, (unsigned long)s.view.copy_count);
    for (c = 0; c < s.view.cell_count; c++) least = fmin(least, s.view.cell_volume[c]);
    scene_check(&s, least > 0.0, "smallest cell: %.2e of the tetrahedron (above 0)", least / scene_mesh_volume(&s));
    off = astray(&s, middle, flight * s.step.dt);
    scene_check(&s, off < 1e-12, "farthest that a piece's centre is off its straight course: %.1e m (below 1e-12)",
                off);
    scene_check_body(&s);
    return scene_close(&s);
}
