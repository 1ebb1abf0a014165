/* accordion: a hanging cube is cut from both sides in turn, and unfolds; a last cut rips it apart (GXFEM, "Elastic
   accordion", Fig. 7).

   16^3 cubes of 5 tetrahedra, edges of 0.17 m on average, held by the top; about 22.8k unknowns in the end, as in the
   paper, which runs 540 frames where this runs 150. Six horizontal cuts, each through 7/8 of the cube, from the bottom
   up, in strips; then a vertical one on one side, down through the top layers: what hung by their fold falls. Three
   pieces are left: it, the fold, and the rest of the top. */
#include "scene.h"

enum { MOST_FOLDS = 6 };

static const double edge = 0.141;   /* of a cube, m */
static const double every = 2.5137; /* cubes from one cut to the next: none lies on a plane of nodes */

/* The cut's level; the top one comes from the right, those below in turn. */
static scene_sheet make_fold(scene *s, uint32_t cubes, int fold, int folds) {
    const double width = cubes * edge, z = (2.2711 + every * fold) * edge;
    const int right = (folds - 1 - fold) % 2 == 0;
    const double corner[3] = {right ? 1.05 * width : -0.05 * width, -0.1 * width, z};
    const double u[3] = {(right ? -0.925 : 0.925) * width, 0, 0}, v[3] = {0, 1.2 * width, 0};
    return scene_flat_sheet(s, corner, u, v, cubes);
}

/* Mean height of the nodes at the bottom of the cube, m */
static double bottom(const scene *s) {
    double sum = 0.0;
    size_t copy, count = 0;
    for (copy = 0; copy < s->view.copy_count; copy++)
        if (!(s->mesh.positions[3 * (size_t)s->view.copy_node[copy] + 2] > 0.0)) {
            sum += s->view.displacement[3 * copy + 2];
            count++;
        }
    return sum / (double)count;
}

/* Downward speed of the centre of the lowest fragment, m/s; 0: nothing has come off yet */
static double falling(scene *s) {
    uint32_t f, lowest = 0;
    if (s->view.fragment_count < 3) return 0.0;
    for (f = 1; f < s->view.fragment_count; f++)
        if (s->view.fragment_center[3 * f + 2] < s->view.fragment_center[3 * lowest + 2]) lowest = f;
    return -scene_motion(s, lowest).velocity[2];
}

int main(int argc, char **argv) {
    const scene_desc desc = {
        .name = "accordion",
        .about = "A hanging cube is cut from both sides in turn, and unfolds; a last cut rips it apart.",
        .mesh = "grid:16,16,16",
        .small_mesh = "grid:6,6,6",
        .frames = 150,
        .small_frames = 24,
        .least_frames = 20};
    scene_sheet folds[MOST_FOLDS], last;
    double level[MOST_FOLDS + 1], mass, speed = 0.0, gain = 0.0, width;
    uint32_t cubes;
    int i, count;
    scene s;
    scene_open(&s, &desc, argc, argv);
    cubes = s.small ? 6 : 16;
    count = s.small ? 2 : MOST_FOLDS;
    width = cubes * edge;
    scene_scale(&s, edge, edge, edge);
    scene_make(&s);
    scene_hold(&s, 2, 1, width - 1e-9);
    mass = scene_mass(&s);
    for (i = 0; i < count; i++) folds[i] = make_fold(&s, cubes, i, count);
    last = scene_flat_sheet(&s, (double[3]){0.2137 * width, -0.1 * width, 1.05 * width},
                            (double[3]){0, 0, (2.2711 + every * (count - 2) - 0.6) * edge - 1.05 * width},
                            (double[3]){0, 1.2 * width, 0}, cubes);
    for (; s.frame < s.frames; scene_step(&s)) {
        for (i = 0; i < count; i++) {
            const double from = 0.1 + 0.7 * i / count;
            if (!folds[i].done && scene_due(&s, from, from + 0.3 / count, 1000)) level[i] = bottom(&s);
            scene_advance(&s, &folds[i], from, from + 0.3 / count);
        }
        if (!last.done && scene_due(&s, 0.85, 0.9, cubes)) level[count] = bottom(&s);
        scene_advance(&s, &last, 0.85, 0.9);
        if (speed > 0.0) gain = falling(&s) - speed;
        speed = falling(&s);
    }
    for (i = 0; i < count; i++)
        scene_check(&s, level[i + 1] < level[i], "bottom after cut %d: %.4f m (below %.4f m)", i + 1, level[i + 1],
                    level[i]);
    scene_check(&s, bottom(&s) < level[count], "bottom in the end: %.4f m (below %.4f m)", bottom(&s), level[count]);
    scene_check(&s, fabs(gain / (9.81 * s.step.dt) - 1.0) < 1e-9, "what falls gains speed by %.9f of gravity (1)",
                gain / (9.81 * s.step.dt));
    scene_check(&s, s.view.fragment_count == 3, "fragments: %lu (3)", (unsigned long)s.view.fragment_count);
    mass = fabs(scene_mass(&s) / mass - 1.0);
    scene_check(&s, mass <= 1e-12, "mass against the uncut cube's: %.1e (at most 1e-12)", mass);
    scene_check_body(&s);
    for (i = 0; i < count; i++) scene_drop_sheet(&folds[i]);
    scene_drop_sheet(&last);
    return scene_close(&s);
}
