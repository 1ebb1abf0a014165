/* sticks: a stretched cube of 5 tetrahedra is cut into 36 sticks by 5 + 5 crossing planes (GXFEM, "Diced cube", Fig.
   5).

   The cube starts stretched sideways, and its foot is held so. Five parallel cuts make six slices of it, of 144
   unknowns (Table 2); five more cross them. The cuts come down in strips over the frames, one after the other. What is
   free of its neighbours springs back to its own width: 36 sticks stand apart on the stretched foot. */
#include "scene.h"

enum { CUTS = 5, STRIPS = 6 };

static const double stretch = 1.5;

/* x and y about the axis of the cube, times `stretch` */
static void pull(scene *s) {
    size_t copy, i;
    for (copy = 0; copy < s->view.copy_count; copy++)
        for (i = 0; i < 2; i++)
            s->view.displacement[3 * copy + i] =
                (stretch - 1.0) * (s->mesh.positions[3 * (size_t)s->view.copy_node[copy] + i] - 0.5);
}

/* Five planes across an axis that come down along z */
static void make_blades(scene *s, uint32_t axis, scene_sheet blades[CUTS]) {
    int i;
    for (i = 0; i < CUTS; i++) {
        double corner[3] = {-0.5, -0.5, 1.5}, u[3] = {0, 0, -2}, v[3] = {2, 2, 0};
        corner[axis] = (i + 1.0) / (CUTS + 1);
        v[axis] = 0.0;
        blades[i] = scene_flat_sheet(s, corner, u, v, STRIPS);
    }
}

/* The five sweep one after the other, from share `from` of the run to share `to`. */
static void advance(scene *s, scene_sheet blades[CUTS], double from, double to) {
    int i;
    for (i = 0; i < CUTS; i++)
        scene_advance(s, &blades[i], from + i * (to - from) / CUTS, from + (i + 1) * (to - from) / CUTS);
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "sticks",
                             .about =
                                 "A stretched cube of 5 tetrahedra is cut into 36 sticks by 5 + 5 crossing planes.",
                             .mesh = "cube5",
                             .frames = 150,
                             .small_frames = 20};
    scene s;
    scene_sheet first[CUTS], second[CUTS];
    unsigned long parallel = 0;
    int i;
    scene_open(&s, &desc, argc, argv);
    scene_make(&s);
    pull(&s);
    scene_hold(&s, 2, -1, 1e-9);
    make_blades(&s, 1, first);
    make_blades(&s, 0, second);
    for (; s.frame < s.frames; scene_step(&s)) {
        advance(&s, first, 0.05, 0.4);
        if (parallel == 0 && first[CUTS - 1].done == STRIPS) {
            scene_look(&s);
            parallel = scene_unknowns(&s);
        }
        advance(&s, second, 0.5, 0.85);
    }
    scene_check(&s, parallel == 144, "unknowns after 5 parallel cuts: %lu (144)", parallel);
    scene_check(&s, s.view.fragment_count == 36, "fragments: %lu (36)", (unsigned long)s.view.fragment_count);
    scene_check_body(&s);
    for (i = 0; i < CUTS; i++) {
        scene_drop_sheet(&first[i]);
        scene_drop_sheet(&second[i]);
    }
    return scene_close(&s);
}
