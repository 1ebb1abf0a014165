/* Calls one function of each header. */
static inline int use_all(void) {
    const double a[2] = {0, 0}, b[2] = {1, 0}, c[2] = {0, 1};
    gx_body_destroy(NULL);
    gxs_solver_destroy(NULL);
    return gxb_orient2d(a, b, c) == 1 && gxi_monomial_count(3) == 20 && gx_result_text(GX_OK) != NULL ? 0 : 1;
}
