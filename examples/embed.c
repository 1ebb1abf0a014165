/* A cube hangs by its top and is cut in two while it moves; six of its frames are written as OBJ files.
   Build: cc -I. examples/embed.c -o embed -lm */
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"
#include <stdio.h>
#include <stdlib.h>

/* The surface as an OBJ file in which each fragment is a group. An engine fills its buffers here. */
static gx_result draw(gx_body *body, int frame) {
    char name[32];
    gx_view view;
    gx_skin skin;
    gx_result result = gx_body_view(body, &view, NULL);
    if (result == GX_OK) result = gx_body_skin(body, NULL, &skin, NULL);
    if (result != GX_OK) return result;
    snprintf(name, sizeof name, "frame_%02d.obj", frame);
    FILE *file = fopen(name, "w");
    double *x = (double *)malloc(3 * skin.vertex_count * sizeof *x);
    if (!file || !x) exit(1);
    result = gx_body_skin_positions(body, x, NULL);
    for (size_t v = 0; v < skin.vertex_count; v++) fprintf(file, "v %g %g %g\n", x[3 * v], x[3 * v + 1], x[3 * v + 2]);
    for (size_t t = 0; t < skin.triangle_count; t++) {
        const uint32_t *v = skin.triangles + 3 * t;
        fprintf(file, "g fragment%u\nf %u %u %u\n", skin.triangle_fragment[t], v[0] + 1, v[1] + 1, v[2] + 1);
    }
    printf("%s: %u fragment%s\n", name, (unsigned)view.fragment_count, view.fragment_count > 1 ? "s" : "");
    free(x);
    fclose(file);
    return result;
}

int main(void) {
    const double nodes[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1}; /* m */
    const uint32_t elements[] = {0, 5, 3, 6, 1, 3, 0, 5, 2, 0, 3, 6, 4, 6, 5, 0, 7, 5, 6, 3};
    const double corners[] = {-9, -9, 0.7, 9, -9, 0.2, 0, 9, 0.5}; /* a triangle larger than the cube, through it */
    const uint32_t triangle[] = {0, 1, 2};
    const gx_region top = gx_region_half_space(2, 1, 0.9); /* axis z, above 0.9 m: nodes there stay where they are */
    static gx_body_desc cube;                              /* static, hence zero: each field has its default */
    static gx_surface sheet;
    static gx_cut_desc cut;
    static gx_step_desc step;
    gx_body *body = NULL;
    cube.positions = nodes, cube.node_count = 8, cube.elements = elements, cube.element_count = 5;
    cube.young = 1e5, cube.poisson = 0.4, cube.density = 1000; /* Pa, -, kg/m3: jelly */
    sheet.vertices = corners, sheet.vertex_count = 3, sheet.triangles = triangle, sheet.triangle_count = 1;
    cut.surfaces = &sheet, cut.surface_count = 1;
    step.dt = 1.0 / 60, step.gravity[0] = 1, step.gravity[2] = -9.81; /* s, m/s2 */
    gx_result result = gx_body_create(&cube, &body, NULL);
    if (result == GX_OK) result = gx_body_hold(body, &top, 1, NULL);
    for (int frame = 0; frame < 60 && result == GX_OK; frame++) {
        if (frame == 30) result = gx_body_cut(body, &cut, NULL, NULL);
        if (result == GX_OK) result = gx_body_step(body, &step, NULL, NULL);
        if (result == GX_OK && frame % 10 == 9) result = draw(body, frame);
    }
    printf("%s\n", gx_result_text(result));
    gx_body_destroy(body);
    return result != GX_OK;
}
