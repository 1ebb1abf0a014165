/* sticks: a stretched cube of 5 tetrahedra is cut into 36 sticks by 5 + 5 crossing planes (GXFEM, "Diced cube", Fig. 5).

   The cube is stretched along x and held at both ends, as in the paper. The first five cuts run along the pull: six bands, 144
   unknowns (Table 2). The second five cross them: 36 sticks along z. All cuts advance in strips over the frames, one after the
   other; sticks that no end holds any more fall. */
#include "scene.h"

enum { CUTS = 5, STRIPS = 6 };

static const double stretch = 1.5;

/* u = (stretch - 1)(x - 1/2) along x; nothing moves yet. */
static void pull(scene *s)
{
    size_t copy;
    for (copy = 0; copy < s->view.copy_count; copy++)
        s->view.displacement[3 * copy] = (stretch - 1.0) * (s->mesh.positions[3 * (size_t)s->view.copy_node[copy]] - 0.5);
}

/* Five planes across an axis that come in along z */
static void make_blades(scene *s, uint32_t axis, scene_sheet blades[CUTS])
{
    int i;
    for (i = 0; i < CUTS; i++) {
        double corner[3] = {-0.5, -0.5, -0.5}, u[3] = {0, 0, 2}, v[3] = {2, 2, 0};
        corner[axis] = (i + 1.0) / (CUTS + 1);
        v[axis] = 0.0;
        blades[i] = scene_flat_sheet(s, corner, u, v, STRIPS);
    }
}

/* The five sweep one after the other, from share `from` of the run to share `to`. */
static void advance(scene *s, scene_sheet blades[CUTS], double from, double to)
{
    int i;
    for (i = 0; i < CUTS; i++) scene_advance(s, &blades[i], from + i * (to - from) / CUTS, from + (i + 1) * (to - from) / CUTS);
}

int main(int argc, char **argv)
{
    const scene_desc desc = {"sticks", "A stretched cube of 5 tetrahedra is cut into 36 sticks by 5 + 5 crossing planes.", "cube5", NULL, 0, 150, 20};
    const gx_region ends[2] = {{0, -1, 1e-9}, {0, 1, 1.0 - 1e-9}};
    scene s;
    scene_sheet along[CUTS], across[CUTS];
    unsigned long parallel = 0;
    int i;
    scene_open(&s, &desc, argc, argv);
    scene_make(&s);
    pull(&s);
    scene_must(&s, gx_body_hold(s.body, ends, 2), "hold");
    make_blades(&s, 1, along);
    make_blades(&s, 0, across);
    for (; s.frame < s.frames; scene_step(&s)) {
        advance(&s, along, 0.05, 0.4);
        if (parallel == 0 && along[CUTS - 1].done == STRIPS) {
            scene_look(&s);
            parallel = scene_unknowns(&s);
        }
        advance(&s, across, 0.5, 0.85);
    }
    scene_check(&s, parallel == 144, "unknowns after 5 parallel cuts: %lu (144)", parallel);
    scene_check(&s, s.view.fragment_count == 36, "fragments: %lu (36)", (unsigned long)s.view.fragment_count);
    scene_check_body(&s);
    for (i = 0; i < CUTS; i++) {
        scene_drop_sheet(&along[i]);
        scene_drop_sheet(&across[i]);
    }
    return scene_close(&s);
}
