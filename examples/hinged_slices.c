/* hinged_slices: a cube of 5 tetrahedra is hinged at one edge and sliced across it at three places; the slices fold
   down (RXFEM, Fig. 10).

   The cube is turned by 45 degrees about its hinge, which then lies farthest to one side, so that holding a half-space
   holds the hinge alone. The far end of the hinge is at a wall: slices fold down one after the other as they are cut
   from it. At rest the centre of mass of each is below the hinge, since the moments about the hinge are in balance. St.
   Venant-Kirchhoff, steps of 5 ms; drag brings the slices to rest. */
#include "scene.h"

enum { CUTS = 3 };

/* (x, y, z) to (x + z, y, z - x): exact; edges across y are of sqrt 2 then. */
static void turn(scene *s) {
    size_t i;
    for (i = 0; i < s->mesh.node_count; i++) {
        double *at = s->mesh.positions + 3 * i;
        const double x = at[0], z = at[2];
        at[0] = x + z;
        at[2] = z - x;
    }
}

int main(int argc, char **argv) {
    const scene_desc desc = {
        .name = "hinged_slices",
        .about = "Slices are cut from a cube of 5 tetrahedra across an edge that is a hinge, and fold down.",
        .mesh = "cube5",
        .frames = 600,
        .small_frames = 600};
    const double edge = 1.4142135623730951; /* across the hinge, m */
    const double y[CUTS] = {0.1, 0.3, 0.6}; /* slices of 0.1, 0.2 and 0.3 m, and 0.4 m at the wall, y = 1 */
    const gx_region held[2] = {gx_region_half_space(0, -1, 1e-9), gx_region_half_space(1, 1, 1.0 - 1e-9)};
    gx_material material = {{GXS_ST_VENANT_KIRCHHOFF, 1e6, 0.4, 0, NULL, NULL}, 1000.0};
    scene_sheet blades[CUTS];
    double residual;
    uint32_t f;
    int i;
    scene s;
    scene_open(&s, &desc, argc, argv);
    turn(&s);
    s.body_desc.materials = &material;
    s.body_desc.material_count = 1;
    s.step.dt = 0.005;
    s.step.mass_damping = 2.0;
    scene_make(&s);
    scene_hold_all(&s, held, 2);
    for (i = 0; i < CUTS; i++) {
        const double corner[3] = {2.5, y[i], -2}, u[3] = {-3, 0, 0}, v[3] = {0, 0, 4};
        blades[i] = scene_flat_sheet(&s, corner, u, v, 8);
    }
    for (; s.frame < s.frames; scene_step(&s))
        for (i = 0; i < CUTS; i++) scene_advance(&s, &blades[i], 0.05 + 0.1 * i, 0.1 + 0.1 * i);
    scene_check(&s, s.view.fragment_count == CUTS + 1, "fragments: %lu (4)", (unsigned long)s.view.fragment_count);
    residual = scene_settle(&s, 1e-10);
    scene_say(&s, "residual of the rest: %.1e", residual);
    for (f = 0; f < s.view.fragment_count; f++) {
        const gx_motion motion = scene_motion(&s, f);
        const double *at = motion.center;
        if (at[1] > y[CUTS - 1]) continue; /* at the wall */
        scene_check(
            &s, fabs(at[0]) < 1e-3 * edge && at[2] < 0.0,
            "slice of %.1f m: centre of mass %.1e of an edge beside the hinge, %.4f m below it (at most 1e-3, below)",
            s.view.fragment_volume[f] / 2.0, fabs(at[0]) / edge, -at[2]);
    }
    scene_check_body(&s);
    for (i = 0; i < CUTS; i++) scene_drop_sheet(&blades[i]);
    return scene_close(&s);
}
