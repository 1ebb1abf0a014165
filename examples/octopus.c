/* octopus: a wavy cut carves a smile, a second one crosses it and lets the jaw drop (GXFEM, "Smiling octopus", Fig. 8).

   Seen along +z the octopus is a ball with arms around and behind it. It is as large as the paper's (edges of 2.4 m),
   at rest under its weight (along -y), held by its arms and by what is behind z = 0.02. The smile is drawn across the
   ball from one corner of the mouth to the other: a sheet along z that ends inside the head. It hardly opens, as
   nothing below it is loose. The second cut crosses it near its end and goes down to a hinge above the chin. */
#include "scene.h"

enum { COLUMNS = 96, ROWS = 12 };

static const double scale = 180.0; /* metres per unit of the mesh: edges of 2.39 m on average (GXFEM Table 1) */

/* Units of the mesh: the middle of the face, its half width, where the mouth ends behind, where the jaw's hinge begins
 * below */
/* clang-format off */
static const double middle[3] = {0.006, -0.072, -0.19}, half_width = 0.12, back = -0.075, hinge = -0.142;

static void mesh_point(double x, double y, double z, double *at)
{
    at[0] = scale * x;
    at[1] = scale * y;
    at[2] = scale * z;
}

/* The mouth's height: a smile with waves on it */
static double smile(double x)
{
    const double t = (x - middle[0]) / half_width;
    return middle[1] + 0.030 * t * t + 0.006 * sin(6.0 * 3.141592653589793 * t);
}

/* a: from left to right, b: inwards */
static void mouth_point(const void *user, double a, double b, double *at)
{
    const double x = middle[0] + half_width * (2.0 * a - 1.0);
    (void)user;
    mesh_point(x, smile(x), middle[2] - 0.02 + b * (back - middle[2] + 0.02), at);
}

/* a: from left to right, b: downwards from above the mouth, a little in front of its end */
static void jaw_point(const void *user, double a, double b, double *at)
{
    const double x = middle[0] + half_width * (2.0 * a - 1.0), top = smile(x) + 0.008;
    (void)user;
    mesh_point(x, top + b * (hinge - top), back - 0.012, at);
}

/* Height of the upper lip above the lower one, at the middle of the face, and of the lower lip */
typedef struct lips { uint32_t upper, lower; } lips;

static lips find_lips(const scene *s)
{
    lips found;
    double x[3];
    mesh_point(middle[0], smile(middle[0]) + 0.016, middle[2], x);
    found.upper = scene_nearest_node(s, x);
    mesh_point(middle[0], smile(middle[0]) - 0.016, middle[2], x);
    found.lower = scene_nearest_node(s, x);
    return found;
}

static double jaw_height(const scene *s, lips of) { return scene_place(s, of.lower)[1]; }

static double mouth_opening(const scene *s, lips of)
{
    const double *up = scene_place(s, of.upper), *low = scene_place(s, of.lower);
    return sqrt(pow(up[0] - low[0], 2.0) + pow(up[1] - low[1], 2.0) + pow(up[2] - low[2], 2.0));
}

static void hold_arms(scene *s)
{
    const gx_region held[4] = {
        gx_region_half_space(2, 1, 0.02 * scale), gx_region_half_space(0, -1, -0.14 * scale),
        gx_region_half_space(0, 1, 0.16 * scale), gx_region_half_space(1, 1, 0.09 * scale)};
    /* clang-format on */
    scene_hold_all(s, held, 4);
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "octopus",
                             .about = "A wavy cut carves the mouth of an octopus, a second one lets its jaw drop.",
                             .mesh = "octopus",
                             .small_mesh = "octopus:0.026",
                             .any_mesh = 1,
                             .frames = 120,
                             .small_frames = 60,
                             .least_frames = 50};
    scene s;
    scene_sheet mouth, jaw;
    lips of;
    double closed, smiling, before, mass;
    scene_open(&s, &desc, argc, argv);
    scene_scale(&s, scale, scale, scale);
    s.body_desc.young = 1e7;
    s.step.gravity[1] = s.step.gravity[2];
    s.step.gravity[2] = 0.0;
    scene_make(&s);
    mass = scene_mass(&s);
    hold_arms(&s);
    scene_settle(&s, 1e-6);
    of = find_lips(&s);
    closed = smiling = mouth_opening(&s, of);
    before = jaw_height(&s, of);
    mouth = scene_make_sheet(&s, COLUMNS, ROWS, mouth_point, NULL);
    jaw = scene_make_sheet(&s, COLUMNS, ROWS, jaw_point, NULL);
    for (; s.frame < s.frames; scene_step(&s)) {
        scene_advance(&s, &mouth, 0.05, 0.35);
        if (jaw.done == 0) {
            smiling = mouth_opening(&s, of);
            before = jaw_height(&s, of);
        }
        scene_advance(&s, &jaw, 0.5, 0.75);
    }
    scene_say(&s, "lips apart, as measured at two points of them: at first %.2f m, with the mouth cut %.2f m", closed,
              smiling);
    scene_check(&s, mouth_opening(&s, of) > closed + 1.0, "lips apart in the end: %.2f m (1 m more than at first)",
                mouth_opening(&s, of));
    scene_check(&s, jaw_height(&s, of) < before - 1.0, "the jaw drops by %.2f m (more than 1 m)",
                before - jaw_height(&s, of));
    mass = fabs(scene_mass(&s) / mass - 1.0);
    scene_check(&s, mass <= 1e-12, "mass against the uncut octopus's: %.1e (at most 1e-12)", mass);
    scene_check_body(&s);
    scene_drop_sheet(&mouth);
    scene_drop_sheet(&jaw);
    return scene_close(&s);
}
