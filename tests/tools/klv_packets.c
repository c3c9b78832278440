/* tests/tools/klv_packets.c: ST 0601 packets of frame records, for decoders that are not ours: klv_packets COUNT SEED
 * writes COUNT packets of random, often absurd records to standard output, and counts on standard error what is
 * refused. A packet must not be written beyond its length, nor contain anything that differs with what was in the
 * buffer. */
#include "sensor/publish/klv/klv.h"

#include <stdlib.h>

static uint64_t seed_of;
static uint64_t drawn;

static double uniform(void) { return random_uniform(seed_of, 1, 0, drawn++); }
static int    below(int n) { return (int)(uniform() * n); }

/* Any double: mostly of the size given, sometimes absurd. */
static double any(double size)
{
    static const double odd[] = {0, -0.0, 1e-300, 1e300, -1e300, 6378137, 90, 180, 360, 20, 50, 19000, -900, 40000};
    switch (below(12)) {
    case 0:
        return NAN;
    case 1:
        return below(2) ? INFINITY : -INFINITY;
    case 2:
        return odd[below((int)(sizeof odd / sizeof *odd))];
    default:
        return size * (2 * uniform() - 1);
    }
}

static void any_text(char *out, size_t size)
{
    for (size_t i = 0; i + 1 < size; i++) out[i] = (char)below(256);
    out[size - 1] = 0;
}

static void rotation(double r[9])
{
    double a[3], b[3], c[3];
    for (int k = 0; k < 3; k++) a[k] = uniform() - 0.5;
    for (int k = 0; k < 3; k++) b[k] = uniform() - 0.5;
    v3_cross(c, a, b);
    v3_cross(b, c, a);
    v3_normalize(a, a);
    v3_normalize(b, b);
    v3_normalize(c, c);
    for (int k = 0; k < 3; k++) {
        r[3 * k] = a[k];
        r[3 * k + 1] = b[k];
        r[3 * k + 2] = c[k];
    }
    if (below(8) == 0) r[below(9)] = any(1);
}

static void position(double p_ecef[3])
{
    static const double pole_m = 6356752.314245;
    switch (below(6)) {
    case 0:
        for (int k = 0; k < 3; k++) p_ecef[k] = any(7e6);
        return;
    case 1:
        p_ecef[0] = p_ecef[1] = 0;
        p_ecef[2] = below(2) ? pole_m + 100 : -pole_m - 100;
        return;
    default: {
        const Geodetic place = {(uniform() - 0.5) * pi_rad, (2 * uniform() - 1) * pi_rad, 45000 * uniform() - 2000};
        ecef_from_geodetic(p_ecef, NULL, &place);
    }
    }
}

static KlvTarget any_target(const View *view, const char *name)
{
    static const char *const algorithm[] = {"truth", "", NULL, "yolo", "a", "b", "c", "d", "e"};
    KlvTarget                t = {.id = (uint64_t)(uniform() * ldexp(1, 1 + below(48))),
                                  .confidence = any(1),
                                  .pixels = any(100),
                                  .located = below(2),
                                  .class_name = below(2) ? name : NULL,
                                  .algorithm = algorithm[below((int)(sizeof algorithm / sizeof *algorithm))],
                                  .algorithm_version = below(2) ? "1.0" : NULL};
    t.place = (Geodetic){any(2), any(4), any(20000)};
    for (int k = 0; k < 4; k++)
        t.box[k] = below(8) ? below((k % 2 ? view->height : view->width) + 1) : below(1 << 30) - (1 << 29);
    return t;
}

int main(int argc, char **argv)
{
    const int count = argc > 1 ? atoi(argv[1]) : 100;
    int       refused = 0;
    seed_of = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    for (int n = 0; n < count; n++) {
        static uint8_t out[2][klv_most_octets + 64];
        SnapshotEntity host = {0};
        RenderRequest  request = {.view = {.width = 1 + below(4096), .height = 1 + below(4096), .focal_px = any(1000)}};
        GroundPoint    footprint[FOOTPRINT_COUNT];
        KlvTarget      target[100];
        char           text[40][40], mission[300];
        for (int k = 0; k < 40; k++) any_text(text[k], sizeof text[k]);
        any_text(mission, sizeof mission);
        any_text(host.marking, sizeof host.marking);
        for (int k = 0; k < 100; k++) target[k] = any_target(&request.view, text[below(40)]);
        for (int k = 0; k < FOOTPRINT_COUNT; k++)
            footprint[k] = (GroundPoint){below(3) > 0, any(2), any(4), any(20000), any(1e6)};
        FrameRecord record = {.frame = below(3) ? n : below(1 << 30),
                              .host = below(2) ? &host : NULL,
                              .request = &request,
                              .hfov_rad = any(3),
                              .footprint = below(4) ? footprint : NULL};
        position(record.p_eye_ecef);
        for (int k = 0; k < 3; k++) record.v_eye_mps[k] = any(400);
        rotation(record.r_ecef_from_body);
        rotation(record.r_ecef_from_cam);
        const KlvSource source = {
            .band = (Band)below(BAND_COUNT), .mission = below(2) ? mission : NULL, .sensor = below(2) ? text[0] : NULL};
        const KlvTargets targets = {below(2), below(101), below(100000), target, below(2), below(1000), any(2e9)};
        const double     unix_s = below(8) ? 1.9e9 * uniform() : any(1e10);

        size_t octets[2];
        for (int k = 0; k < 2; k++) {
            memset(out[k], k ? 0xFF : 0, sizeof out[k]);
            octets[k] = klv_frame(out[k], &record, unix_s, &source, &targets);
            for (size_t i = octets[k] ? octets[k] : klv_most_octets; i < sizeof out[k]; i++)
                if (out[k][i] != (k ? 0xFF : 0)) {
                    fprintf(stderr, "klv_packets: packet %d: octet %zu written behind its end\n", n, i);
                    return 1;
                }
        }
        if (octets[0] != octets[1] || memcmp(out[0], out[1], octets[0]) != 0) {
            fprintf(stderr, "klv_packets: packet %d differs between two calls\n", n);
            return 1;
        }
        refused += octets[0] == 0;
        if (octets[0] == 0 && unix_s >= 0 && unix_s < 7e9) {
            fprintf(stderr, "klv_packets: packet %d: refused\n", n);
            return 1;
        }
        fwrite(out[0], 1, octets[0], stdout);
    }
    fprintf(stderr, "%d packets, %d refused\n", count, refused);
    return 0;
}
