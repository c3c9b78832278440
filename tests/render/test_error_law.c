/* The law by which means over n x n samples tell their own error. The budgets of frames: tests/sensor.
 * labels: physics */
#include "render/frame/render.h"
#include "tests/check.h"

/* Half planes at all angles and places over the turned grid, whose covered area is
 * known on paper. */
static double covered(double nx, double ny, double d)
{
    const double a = fmax(fabs(nx), fabs(ny)), b = fmax(fmin(fabs(nx), fabs(ny)), 1e-9), u = d + 0.5 * (a + b);
    const double x[4] = {fmax(u, 0), fmax(u - a, 0), fmax(u - b, 0), fmax(u - a - b, 0)};
    return clamp((x[0] * x[0] - x[1] * x[1] - x[2] * x[2] + x[3] * x[3]) / (2 * a * b), 0, 1);
}

static void the_law_is_that_of_half_planes(void **state)
{
    (void)state;
    for (int n = 2; n <= 16; n += n) {
        double truth = 0, law = 0;
        for (int k = 0; k < 4000; k++) {
            const double turn = 2 * pi_rad * random_uniform(1, 1, (uint32_t)n, (uint64_t)(2 * k)), nx = cos(turn),
                         ny = sin(turn);
            const double half = 0.5 * (fabs(nx) + fabs(ny)),
                         d = half * (2 * random_uniform(1, 1, (uint32_t)n, (uint64_t)(2 * k + 1)) - 1);
            float in[256];
            int   count = 0;
            for (int s = 0; s < n * n; s++) {
                /* the grid turned by atan(1 / n) */
                const double x = (s % n + (s / n + 0.5) / n) / n, y = (s / n + (n - s % n - 0.5) / n) / n;
                in[s] = nx * (x - 0.5) + ny * (y - 0.5) < d;
                count += in[s] > 0;
            }
            law += render_error_variance(in, n);
            const double error = (double)count / (n * n) - covered(nx, ny, d);
            truth += error * error;
        }
        const double ratio = sqrt(law / truth);
        print_message("%2d x %-2d: rms by the law over the true one %.3f\n", n, n, ratio);
        CHECK_NEAR(ratio, 1, 0.15); /* what one constant for all grids costs, and 4000 draws */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_law_is_that_of_half_planes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
