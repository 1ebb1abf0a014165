/* lips: a bar is cut from above to its middle, bent until the cut gapes, then bent back and the other way, so that the
   lips of the cut press on each other.

   Without contact the lips would go through each other. The depth of the one in the other is looked at from outside. */
#include "scene.h"

#include "touching.h"

/* m: of the bar; how far up the cut begins */
static const double length = 0.3, height = 0.06, depth = 0.015;

/* Both ends turn about y, by an angle that is above 0 where the cut opens: poses of two regions */
static void bend(double angle, double poses[24]) {
    int end;
    for (end = 0; end < 2; end++) {
        const double a = end == 0 ? -angle : angle, x = end == 0 ? 0.0 : length, z = 0.5 * height;
        double *p = poses + 12 * end;
        memset(p, 0, 12 * sizeof *p);
        p[0] = p[10] = cos(a);
        p[2] = sin(a);
        p[8] = -sin(a);
        p[5] = 1.0;
        p[3] = x - p[0] * x - p[2] * z;
        p[11] = z - p[8] * x - p[10] * z;
    }
}

/* Opens, then closes and goes on. */
static double angle_at(const scene *s, double most, double least) {
    const double open = scene_share(s, s->frame, 0.1, 0.4), closed = scene_share(s, s->frame, 0.5, 0.9);
    return most * open + (least - most) * closed;
}

static double load_of_lips(scene *s, size_t *count) {
    static gx_contact contacts[4096];
    double load = 0.0;
    size_t i;
    scene_must(s, gx_body_contacts(s->body, contacts, 4096, count, &s->failure), "contacts");
    for (i = 0; i < *count; i++) load += fabs(contacts[i].force[0]);
    return load;
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "lips",
                             .about = "The lips of a cut open, close again and press on each other.",
                             .mesh = "grid:40,8,8",
                             .small_mesh = "grid:20,4,4",
                             .frames = 120,
                             .small_frames = 60,
                             .least_frames = 40};
    const double corner[3] = {0.5 * length + 0.0013, -0.1, height + 0.01}, u[3] = {0, 0.3, 0};
    const double v[3] = {0, 0, depth - height - 0.01};
    double poses[24], open = 0.0, load;
    size_t count;
    gx_region ends[2];
    scene s;
    touching on;
    scene_open(&s, &desc, argc, argv);
    scene_scale(&s, length / (s.small ? 20 : 40), height / (s.small ? 4 : 8), height / (s.small ? 4 : 8));
    s.body_desc.young = 1e5;
    s.step.dt = 2.0 / s.frames;
    s.step.mass_damping = 5.0;
    s.step.newton_iterations = 2;
    s.step.region_poses = poses;
    scene_make(&s);
    ends[0] = gx_region_half_space(0, -1, 0.1 * length);
    ends[1] = gx_region_half_space(0, 1, 0.9 * length);
    scene_hold_all(&s, ends, 2);
    touching_begin(&s, &on, 0.3, -HUGE_VAL);
    scene_cut_flat(&s, corner, u, v);
    while (s.frame < s.frames) {
        bend(angle_at(&s, 0.5, -0.1), poses);
        scene_step(&s);
        touching_look(&s, &on);
        open = fmax(open, scene_mean_gap(&s, 0.0));
    }
    load = load_of_lips(&s, &count);
    scene_check(&s, s.view.fragment_count == 1, "pieces: %lu (1)", (unsigned long)s.view.fragment_count);
    scene_check(&s, open > 0.01, "the lips open by %.4f m in the mean (more than 0.01 m)", open);
    scene_check(&s, count > 0 && load > 1.0, "in the end they press with %.1f N at %lu places (more than 1 N)", load,
                (unsigned long)count);
    touching_check_depths(&s, &on, 0.05, 0.05);
    scene_check_body(&s);
    return scene_close(&s);
}
