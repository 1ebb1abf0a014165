/* slab_in_five: a slab is cut into five slices of increasing thickness (RXFEM, Fig. 11).

   61 x 11 x 1 cubes of 5 tetrahedra, held at x = 0; St. Venant-Kirchhoff, steps of 5 ms. The four planes come in
   together from the free end, one row of cubes after the other. RXFEM gives neither size nor stiffness: cubes of 1 cm,
   and 30 MPa, let the slices droop by a good part of their length. */
#include "slab.h"

enum { PLANES = 4, SLICES = PLANES + 1 };

int main(int argc, char **argv) {
    const scene_desc desc = {
        .name = "slab_in_five",
        .about = "A slab is cut into five slices of 1/15 to 5/15 of its thickness, which droop each on its own.",
        .mesh = "grid:61,11,1",
        .small_mesh = "grid:15,3,1",
        .frames = 300,
        .small_frames = 16,
        .has_csv = 1};
    const double edge = 0.01; /* of a cube, m */
    const double z[PLANES] = {edge / 15, 3 * edge / 15, 6 * edge / 15, 10 * edge / 15};
    gx_material material = {{GXS_ST_VENANT_KIRCHHOFF, 3e7, 0.4, 0, NULL, NULL}, 1000.0};
    scene_sheet planes[PLANES];
    slab_strip strip = {0};
    double drops[SLICES], length;
    scene s;
    int i;
    scene_open(&s, &desc, argc, argv);
    scene_scale(&s, edge, edge, edge);
    s.body_desc.materials = &material;
    s.body_desc.material_count = 1;
    s.body_desc.young = material.elastic.young;
    s.step.dt = 0.005;
    scene_make(&s);
    scene_hold(&s, 0, -1, 1e-9);
    strip.cubes = s.small ? 15 : 61;
    length = strip.cubes * edge;
    for (i = 0; i < PLANES; i++) {
        const double corner[3] = {length + 0.5 * edge, -1, z[i]}, u[3] = {-length - edge, 0, 0}, v[3] = {0, 3, 0};
        planes[i] = scene_flat_sheet(&s, corner, u, v, strip.cubes + 1);
    }
    for (; s.frame < s.frames; scene_step(&s))
        for (i = 0; i < PLANES; i++) scene_advance(&s, &planes[i], 0.05, 0.5);
    scene_check(&s, s.view.fragment_count == SLICES, "fragments: %lu (5)", (unsigned long)s.view.fragment_count);
    slab_judge(&s, z, PLANES, NULL, length, "slices", drops);
    for (i = 0; i < SLICES; i++) scene_say(&s, "slice of %d/15 of the thickness: drop at rest %.4f m", i + 1, drops[i]);
    scene_check_body(&s);
    strip.edge = edge;
    strip.z = z;
    strip.z_count = PLANES;
    strip.most_elements = s.small ? 8000 : 160000;
    slab_study(&s, &strip);
    for (i = 0; i < PLANES; i++) scene_drop_sheet(&planes[i]);
    return scene_close(&s);
}
