/* overhang: the prongs of a fork hang into one another, as fragments do not collide. A blade passes through both at
   once, then again through their two ends, while the upper one falls.

   The lower prong lies on the ground. The upper one sags into it: there a point in space is two points of the material.
   The blade cuts each prong where it meets it, in space. So each end has the volume that was beyond the blade when it
   came, though the two prongs are cut at different places of the material. */
#include "scene.h"

enum { PASSES = 2, LOWER = 0, UPPER = 1 };

static const double slot[3] = {0.4, 0.4, 0.6}; /* between the prongs: x where it begins, z below and above, m */

static int is_fork(const void *user, const double center[3]) {
    (void)user;
    return center[0] < slot[0] || center[2] < slot[1] || center[2] > slot[2];
}

/* By a height at rest, beyond the slot's begin */
static int prong(double z) { return z > 0.5 * (slot[1] + slot[2]) ? UPPER : LOWER; }

/* The blade stands upright at an x and goes along y. */
static void upright_point(const void *user, double a, double b, double *at) {
    at[0] = *(const double *)user;
    at[1] = -0.15 + 1.1 * a;
    at[2] = -2.0 + 4.0 * b;
}

/* Where a corner of a cell is at rest and now */
static const double *corner_rest(const scene *s, size_t corner) {
    return s->mesh.positions + 3 * (size_t)s->view.copy_node[s->view.cell_copies[corner]];
}

static double corner_place(const scene *s, size_t corner, int axis) {
    return corner_rest(s, corner)[axis] + s->view.displacement[3 * (size_t)s->view.cell_copies[corner] + (size_t)axis];
}

/* How far the upper prong's lower side is below the lower prong's upper side, the mean beyond an x in space, m */
static double overlap(const scene *s, double x) {
    double sum[2] = {0, 0}, count[2] = {0, 0};
    size_t c;
    for (c = 0; c < 4 * s->view.cell_count; c++) {
        const double z = corner_rest(s, c)[2];
        const int upper = fabs(z - slot[2]) < 1e-9, lower = fabs(z - slot[1]) < 1e-9;
        if ((!upper && !lower) || corner_rest(s, c)[0] < slot[0] || corner_place(s, c, 0) < x) continue;
        sum[upper] += corner_place(s, c, 2);
        count[upper] += 1.0;
    }
    return sum[LOWER] / count[LOWER] - sum[UPPER] / count[UPPER];
}

/* The share of a tetrahedron in which a linear function, given at its corners, is above 0 */
static double share_above(const double d[4]) {
    double share = 0.0;
    int i, j;
    for (i = 0; i < 4; i++) { /* by divided differences of max(d, 0)^3 */
        double divisor = 1.0;
        if (d[i] <= 0.0) continue;
        for (j = 0; j < 4; j++)
            if (j != i) divisor *= d[i] - d[j];
        share += d[i] * d[i] * d[i] / divisor;
    }
    return share;
}

/* Volume of a prong beyond an x in space, m3. No cut has been near there yet. */
static double volume_beyond(const scene *s, int which, double x) {
    double volume = 0.0, low, high, d[4];
    size_t c, i;
    for (c = 0; c < s->view.cell_count; c++) {
        if (prong(corner_rest(s, 4 * c)[2]) != which) continue;
        for (i = 0; i < 4; i++) d[i] = corner_place(s, 4 * c + i, 0) - x + 1e-7 * (double)i; /* no two are equal */
        low = fmin(fmin(d[0], d[1]), fmin(d[2], d[3]));
        high = fmax(fmax(d[0], d[1]), fmax(d[2], d[3]));
        volume += s->view.cell_volume[c] * (low >= 0.0 ? 1.0 : high <= 0.0 ? 0.0 : share_above(d));
    }
    return volume;
}

/* Volume of the fragments of a prong whose centres were beyond an x at rest, m3 */
static double volume_of_fragments(const scene *s, int which, double x) {
    double volume = 0.0;
    size_t f;
    for (f = 0; f < s->view.fragment_count; f++)
        if (s->view.fragment_center[3 * f] > x && prong(s->view.fragment_center[3 * f + 2]) == which)
            volume += s->view.fragment_volume[f];
    return volume;
}

static void check_ends(scene *s, const double *cuts, double expected[PASSES][2]) {
    static const char *const names[2] = {"lower", "upper"};
    int i, which;
    for (i = 0; i < PASSES; i++)
        for (which = 0; which < 2; which++) {
            const double volume = volume_of_fragments(s, which, cuts[i]), off = volume / expected[i][which] - 1.0;
            scene_check(s, fabs(off) < 0.03,
                        "pass %d: beyond it %.4f m3 of the %s prong, %+.2f %% of what was there before (3 %%)", i + 1,
                        volume, names[which], 100.0 * off);
        }
}

int main(int argc, char **argv) {
    const scene_desc desc = {
        .name = "overhang",
        .about = "The prongs of a fork hang into one another; a blade passes through both at once and cuts each.",
        .mesh = "grid:24,8,10,6",
        .small_mesh = "grid:12,4,5,6",
        .frames = 120,
        .small_frames = 60,
        .least_frames = 20};
    const double cuts[PASSES] = {1.23, 1.87}, from[PASSES] = {0.1, 0.6}, lasts = 0.3;
    double expected[PASSES][2] = {{0, 0}, {0, 0}};
    scene s;
    scene_blade blade;
    int i, which;
    scene_open(&s, &desc, argc, argv);
    scene_scale(&s, 2.4 / (s.small ? 12 : 24), 0.8 / (s.small ? 4 : 8), 1.0 / (s.small ? 5 : 10));
    scene_keep(&s, is_fork, NULL);
    s.body_desc.young = s.small ? 4e6 : 5e6;
    s.step.dt = 0.6 / s.frames;
    scene_make(&s);
    scene_hold(&s, 2, -1, 0.05);
    scene_settle(&s, 1e-6);
    for (i = 0; i < PASSES; i++)
        scene_check(&s, overlap(&s, cuts[i]) > 0.05,
                    "the upper prong is inside of the lower one beyond x = %.2f m: by %.3f m (above 0.05 m)", cuts[i],
                    overlap(&s, cuts[i]));
    blade = scene_make_blade(&s, NULL);
    for (; s.frame < s.frames; scene_step(&s))
        for (i = 0; i < PASSES; i++) {
            for (which = 0; which < 2 && scene_share(&s, s.frame, from[i], from[i] + lasts) <= 0.0; which++)
                expected[i][which] = volume_beyond(&s, which, cuts[i]);
            scene_stroke(&s, &blade, upright_point, &cuts[i], 1, from[i], from[i] + lasts);
        }
    scene_check(&s, s.view.fragment_count == 5, "fragments: %lu (5: the fork, two ends, two ends of these)",
                (unsigned long)s.view.fragment_count);
    check_ends(&s, cuts, expected);
    scene_check(&s, blade.layers >= 2, "pieces near the blade at once: %lu (2 or more)", (unsigned long)blade.layers);
    scene_say(&s, "the cuts are off the blade's path by %.1e m at most, the smallest link is %.1e of its face",
              blade.deviation, blade.min_link_ratio);
    scene_check_whole(&s);
    return scene_close(&s);
}
