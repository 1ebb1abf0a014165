/* Cuts a cube of five tetrahedra in two, steps it for a second, counts the pieces: gxfem in twenty lines.
   Build: cc -I. examples/embed.c -o embed -lm */
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"
#include <stdio.h>

int main(void) {
    const double nodes[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
    const uint32_t elements[] = {0, 5, 3, 6, 1, 3, 0, 5, 2, 0, 3, 6, 4, 6, 5, 0, 7, 5, 6, 3};
    const double corners[] = {0.4, -9, -9, 0.4, 9, -9, 0.4, 0, 9};
    const uint32_t triangle[] = {0, 1, 2};
    gx_body_desc body_desc = {.positions = nodes,
                              .node_count = 8,
                              .elements = elements,
                              .element_count = 5,
                              .young = 1e6,
                              .poisson = 0.4,
                              .density = 1000.0}; /* Pa, -, kg/m3 */
    gx_surface sheet = {.vertices = corners, .vertex_count = 3, .triangles = triangle, .triangle_count = 1};
    gx_cut_desc cut_desc = {.surfaces = &sheet, .surface_count = 1};
    gx_step_desc step_desc = {.dt = 0.033, .gravity = {0.0, 0.0, -9.81}}; /* s, m/s2 */
    gx_body *body = NULL;
    gx_view view = {0};
    gx_result result = gx_body_create(&body_desc, &body, NULL);
    if (result == GX_OK) result = gx_body_cut(body, &cut_desc, NULL, NULL);
    for (int i = 0; i < 30 && result == GX_OK; i++) result = gx_body_step(body, &step_desc, NULL, NULL);
    if (result == GX_OK) result = gx_body_view(body, &view);
    printf("%s: %lu fragments\n", gx_result_text(result), (unsigned long)view.fragment_count);
    gx_body_destroy(body);
    return result != GX_OK;
}
