/* thin_slab: a slab is cut into sheets, the first of them into thinner and thinner ones, and all of them by one last
   cut across (GXFEM, "Thinly cut slab", Fig. 1).

   12 x 15 x 1 cubes of 5 tetrahedra, edges of 0.14 m on average, held at x = 0; 7008 unknowns after the last cut, of
   the paper's 7.2k. The paper runs 450 frames, this 150. The sheets lie inside one layer of elements: four planes come
   in from the free end, one after the other. The last cut goes across them all at three fifths of the length: what is
   beyond falls, and the sheets rise. */
#include "slab.h"

enum { PLANES = 4, SHEETS = PLANES + 1 };

/* of a cube, m: edges of tetrahedra are of 1 and sqrt 2 of it, three of each a cube */
static const double edge = 0.116;

int main(int argc, char **argv) {
    const scene_desc desc = {
        .name = "thin_slab",
        .about = "A slab is cut into sheets of 1/20 to 3/5 of its thickness, then all of them by one cut across.",
        .mesh = "grid:12,15,1",
        .small_mesh = "grid:6,4,1",
        .frames = 150,
        .small_frames = 16,
        .has_csv = 1};
    const double z[PLANES] = {0.05 * edge, 0.1 * edge, 0.2 * edge, 0.4 * edge};
    double before[SHEETS], after[SHEETS], length, across;
    scene_sheet planes[PLANES], last;
    slab_strip strip;
    scene s;
    int i;
    scene_open(&s, &desc, argc, argv);
    scene_scale(&s, edge, edge, edge);
    scene_make(&s);
    scene_hold(&s, 0, -1, 1e-9);
    length = (s.small ? 6 : 12) * edge;
    across = (s.small ? 3.37 : 7.37) * edge;
    for (i = 0; i < PLANES; i++) {
        const double corner[3] = {1.1 * length, -9, z[i]}, u[3] = {-1.2 * length, 0, 0}, v[3] = {0, 18, 0};
        planes[i] = scene_flat_sheet(&s, corner, u, v, 24);
    }
    last = scene_flat_sheet(&s, (double[3]){across, -0.1 * edge, -1}, (double[3]){0, 15.2 * edge, 0},
                            (double[3]){0, 0, 2}, 15);
    for (; s.frame < s.frames; scene_step(&s)) {
        for (i = 0; i < PLANES; i++) scene_advance(&s, &planes[PLANES - 1 - i], 0.05 + 0.12 * i, 0.15 + 0.12 * i);
        if (last.done == 0 && scene_due(&s, 0.6, 0.75, 15)) slab_judge(&s, z, PLANES, NULL, across, "sheets", before);
        scene_advance(&s, &last, 0.6, 0.75);
    }
    slab_judge(&s, z, PLANES, &across, across, "sheets cut across", after);
    for (i = 0; i < SHEETS; i++)
        scene_check(&s, after[i] < before[i],
                    "sheet of %.2f of the thickness: drop %.4f m, after the last cut %.4f m (less)",
                    ((i < PLANES ? z[i] : edge) - (i ? z[i - 1] : 0)) / edge, before[i], after[i]);
    scene_check_body(&s);
    memset(&strip, 0, sizeof strip);
    strip.cubes = s.small ? 6 : 12;
    strip.edge = edge;
    strip.z = z;
    strip.z_count = PLANES;
    strip.most_elements = s.small ? 4000 : 250000;
    slab_study(&s, &strip);
    for (i = 0; i < PLANES; i++) scene_drop_sheet(&planes[i]);
    scene_drop_sheet(&last);
    return scene_close(&s);
}
