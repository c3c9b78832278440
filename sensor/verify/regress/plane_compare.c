/* sensor/verify/regress/plane_compare.c: pixel-wise comparison of planes of numbers and of ids. */
#include "sensor/verify/regress/verdict.h"

#include "render/materials/planck.h"

static double difference_of(float expected, float got)
{
    if (isnan(expected) && isnan(got)) return 0;
    if (expected == got) return 0;
    const double d = (double)got - (double)expected;
    return isnan(d) ? INFINITY : d;
}

void verdict_compare_numbers(PlaneVerdict *out, float *difference, const float *expected, const float *got, int width,
                             int height, const PlaneLimits *limits)
{
    const double   absolute = limits->absolute, relative = limits->relative;
    const uint8_t *ignored = limits->ignored;
    PlaneVerdict   v = {.column = -1, .row = -1};
    double         sum = 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const size_t i = (size_t)y * (size_t)width + (size_t)x;
            if (difference) difference[i] = 0;
            if (ignored && ignored[i]) continue;
            const double d = difference_of(expected[i], got[i]);
            const double limit = isfinite(expected[i]) ? absolute + relative * fabs((double)expected[i]) : absolute;
            if (difference) difference[i] = (float)d;
            v.compared++;
            v.beyond += !(fabs(d) <= limit);
            if (isfinite(d)) sum += d * d;
            else v.unmatched++;
            if (fabs(d) > v.max) {
                v.max = fabs(d);
                v.column = x;
                v.row = y;
                v.expected = (double)expected[i];
                v.got = (double)got[i];
            }
        }
    v.rms = v.compared > v.unmatched ? sqrt(sum / (double)(v.compared - v.unmatched)) : 0;
    v.share = v.compared ? (double)v.beyond / (double)v.compared : 0;
    *out = v;
}

void verdict_compare_ids(PlaneVerdict *out, size_t *edges, const uint32_t *expected, const uint32_t *got, int width,
                         int height, const uint8_t *allowed)
{
    PlaneVerdict v = {.column = -1, .row = -1};
    size_t       at_edge = 0, differ = 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const size_t i = (size_t)y * (size_t)width + (size_t)x;
            v.compared++;
            if (expected[i] == got[i]) continue;
            differ++;
            if (allowed && allowed[i]) {
                at_edge++;
                continue;
            }
            v.beyond++;
            if (v.column >= 0) continue;
            v.max = 1;
            v.column = x;
            v.row = y;
            v.expected = expected[i];
            v.got = got[i];
        }
    v.rms = v.compared ? sqrt((double)differ / (double)v.compared) : 0;
    v.share = v.compared ? (double)v.beyond / (double)v.compared : 0;
    *out = v;
    if (edges) *edges = at_edge;
}

static bool at_edge_of(const uint32_t *id, int x, int y, int width, int height)
{
    const size_t w = (size_t)width, i = (size_t)y * w + (size_t)x;
    return (x > 0 && id[i - 1] != id[i]) || (x + 1 < width && id[i + 1] != id[i]) || (y > 0 && id[i - w] != id[i]) ||
           (y + 1 < height && id[i + w] != id[i]);
}

size_t verdict_mark_edges(uint8_t *edge, const uint32_t *expected, const uint32_t *got, int width, int height)
{
    size_t count = 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            uint8_t *at = &edge[(size_t)y * (size_t)width + (size_t)x];
            if (at_edge_of(expected, x, y, width, height) || at_edge_of(got, x, y, width, height)) *at = 1;
            count += *at;
        }
    return count;
}

void verdict_plane_to_kelvin(float *out, const float *radiance_w_m2_sr, size_t count, double low_m, double high_m)
{
    /* rounding makes many neighbours equal: reuse the last result */
    float last = NAN, last_k = NAN;
    for (size_t i = 0; i < count; i++) {
        const float v = radiance_w_m2_sr[i];
        if (v != last) {
            last = v;
            last_k = !(isfinite(v) && v >= 0) ? NAN
                     : v > 0 ? (float)fmax(apparent_floor_k, planck_band_inverse(low_m, high_m, (double)v))
                             : (float)apparent_floor_k;
        }
        out[i] = last_k;
    }
}

void verdict_plane_to_db(float *out, const float *power, size_t count, double full, double span_db)
{
    for (size_t i = 0; i < count; i++) {
        const double db = full > 0 && power[i] > 0 ? 10 * log10((double)power[i] / full) : -INFINITY;
        out[i] = isnan(power[i]) ? NAN : (float)fmax(-span_db, db);
    }
}
