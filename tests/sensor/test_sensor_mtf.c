/* Modulation transfer of every preset by slanted edge on its raw counts, noise off, along rows and along columns: a
 * plate of a rendered picture against optics of all the band's wavelengths, footprint and jitter. labels: physics */
#include "tests/render/hand_world.h"

#include "sensor/detector/chain.h"
#include "sensor/detector/blur_private.h"

enum { wide_px = 256, high_px = 160, bins_per_px = 32 };
static const double eye_enu[3] = {0, 0, 3000}, focal_px = 2250, slant_rad = 5 * rad_per_deg;

static int open_world(void **state)
{
    (void)state;
    return hand_open(false);
}

/* A plate so near that one edge alone is in the picture, through its middle, turned by the slant: its left edge, or its
 * upper one. */
static Picture shoot_edge(bool upper, double behind_lwir, double behind_mwir)
{
    const View view =
        hand_view(eye_enu, (const double[3]){1, 0, 0}, upper ? high_px : wide_px, upper ? wide_px : high_px, focal_px);
    const double range_m = 2 * focal_px / 1200, a = slant_rad;
    /* forward to the eye, right to the image's left, down; turned about forward */
    const double r[9] = {-1, 0, 0, 0, cos(a), -sin(a), 0, -sin(a), -cos(a)};
    double       offset[3];
    const double edge_body[3] = {0, upper ? 0 : hand_plate_y_m, upper ? -2 * hand_plate_z_m : -hand_plate_z_m};
    double       p_enu[3] = {eye_enu[0] + range_m, eye_enu[1], eye_enu[2]};
    m3_mul_v3(offset, r, edge_body);
    v3_sub(p_enu, p_enu, offset);
    for (int i = 0; i <= air_sky_ups; i++) {
        hand.air.sky_eye[AIR_LWIR].thermal_w_m2_sr[i] = (float)behind_lwir;
        hand.air.sky_eye[AIR_MWIR].thermal_w_m2_sr[i] = (float)behind_mwir;
    }
    hand_clear();
    hand_add(hand_plate_model, p_enu, r);
    RenderRequest request = hand_request(&view);
    request.optical = OPTICAL_RGB;
    request.hand_over_cells = true;
    arena_reset(hand.arena);
    return hand_render(&request, hand.pool);
}

/* 32 bins a pixel: rays at an edge stand in 16 steps, which finer bins do not mix (with 4 bins a pixel the same edge of
 * exact 4 x 4 rays measures 0.011 low at 0.4 cycles a pixel, with 32 right to 0.0001).
 * Spread of the edge in bins across it, its slope, and the slope's transform at f; bins and slope by bin have their own
 * sinc, taken out. */
static double measured(const double *value, int width, int height, bool upper, double f)
{
    enum { half = wide_px / 2 - 8, bins = 2 * half * bins_per_px };
    static double sum[bins];
    static int    count[bins];
    double        re = 0, im = 0, all = 0, last = NAN;
    memset(sum, 0, sizeof sum);
    memset(count, 0, sizeof count);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const double u = x + 0.5 - 0.5 * width, v = y + 0.5 - 0.5 * height;
            const double d = upper ? v * cos(slant_rad) + u * sin(slant_rad) : u * cos(slant_rad) - v * sin(slant_rad);
            const int    bin = (int)floor((d + half) * bins_per_px);
            if (bin < 0 || bin >= bins) continue;
            sum[bin] += value[y * width + x];
            count[bin]++;
        }
    for (int k = 0; k < bins; k++) {
        if (count[k] == 0) continue;
        const double now = sum[k] / count[k], slope = isnan(last) ? 0 : now - last;
        const double phase = 2 * pi_rad * f * k / bins_per_px;
        last = now;
        re += slope * cos(phase);
        im += slope * sin(phase);
        all += slope;
    }
    return sqrt(re * re + im * im) / fabs(all) / (mtf_sinc(f / bins_per_px) * mtf_sinc(f / bins_per_px));
}

static double photons_at(double wavelength_m, double temp_k)
{
    return pow(wavelength_m * 1e6, -4) / expm1(1.438776877e-2 / (wavelength_m * temp_k));
}

/* Diffraction of all wavelengths of a band by their photons; temp_k 0: of the middle of the band alone. */
static double optics(const SensorPreset *p, double low_m, double high_m, double temp_k, double f)
{
    double sum = 0, all = 0;
    enum { n = 400 };
    for (int i = 0; i < n; i++) {
        const double w_m = temp_k > 0 ? low_m + (high_m - low_m) * (i + 0.5) / n : 0.5 * (low_m + high_m);
        const double q = temp_k > 0 ? photons_at(w_m, temp_k) : 1;
        sum += q * mtf_aperture(f * w_m * p->photons.f_number / p->photons.pitch_m, p->obscuration);
        all += q;
    }
    return sum / all;
}

static const struct {
    const char     *name;
    OpticalChannels optical;
} sensors[] = {{"staring_lwir", OPTICAL_PAN}, {"staring_mwir", OPTICAL_PAN}, {"scanning_flir", OPTICAL_PAN},
               {"tv", OPTICAL_RGB},           {"tv", OPTICAL_PAN},           {"tv", OPTICAL_NIR}};

static void check_edge(const Picture *picture, bool upper, const char *what)
{
    static const double still[2] = {0, 0};
    static double       value[wide_px * high_px];
    const int           w = picture->width, h = picture->height;
    for (size_t s = 0; s < sizeof sensors / sizeof *sensors; s++) {
        char         path[512];
        SensorPreset p;
        Chain       *chain;
        CHECK(etc_path(path, sizeof path, "sensors.csv"));
        assert_int_equal(preset_read(&p, path, sensors[s].name), STATUS_OK);
        p.noise_scale = p.prnu = p.bad_share = p.ac_per_line = 0;
        p.auto_exposure = false;
        p.bits = 16;
        p.dark_e_s = 0;
        p.optical = sensors[s].optical;
        preset_refresh(&p);
        const float *in[3] = {picture->optical[0], picture->optical[1], picture->optical[2]};
        if (p.band == BAND_MWIR) in[0] = picture->mwir;
        if (p.band == BAND_LWIR) in[0] = picture->lwir;
        double most = 0;
        for (int i = 0; i < w * h; i++) most = fmax(most, (double)in[0][i]);
        assert_int_equal(chain_create(&chain, &p, w, h, render_places(1, 4), 1), STATUS_OK);
        const double counts = chain_counts_at(chain, 0, most);
        chain_destroy(chain);
        p.photons.integration_s *= 30000 / counts; /* the converter's steps do not count */
        assert_int_equal(chain_create(&chain, &p, w, h, render_places(1, 4), 1), STATUS_OK);
        chain_run(chain, in, &picture->small, 0, still);
        for (int c = 0; c < (sensors[s].optical == OPTICAL_RGB ? 3 : 1); c++) {
            double low_m, high_m, worst = 0, middle = 0;
            preset_band(&low_m, &high_m, p.band, p.optical, p.optical == OPTICAL_RGB ? c : -1);
            for (int i = 0; i < w * h; i++) value[i] = chain_counts(chain, c)[i];
            for (double f = 0.05; f < 0.401; f += 0.05) {
                const double fx = f * cos(slant_rad), fy = f * sin(slant_rad),
                             temp_k = p.band == BAND_OPTICAL ? 5772 : 300;
                const double rest = mtf_sinc(p.footprint * fx) * mtf_sinc(p.footprint * fy) *
                                    exp(-2 * pow(pi_rad * p.jitter_px * f, 2));
                const double want = optics(&p, low_m, high_m, temp_k, f) * rest, got = measured(value, w, h, upper, f);
                if (fabs(got - want) > fabs(worst)) worst = got - want;
                const double off = optics(&p, low_m, high_m, 0, f) * rest - want;
                if (fabs(off) > fabs(middle)) middle = off;
            }
            CHECK_NEAR(worst, 0, 0.005);
            /* the twin: what one wavelength in the middle would give is seen */
            if (p.band == BAND_MWIR) CHECK(fabs(middle) > 0.02);
            print_message("%s, %s edge, %s channel %d: %+.4f; the middle of the band: %+.4f\n", what,
                          upper ? "upper" : "left", p.name, c, worst, middle);
        }
        chain_destroy(chain);
    }
}

static void edges_show_the_optics(void **state)
{
    (void)state;
    static const double sun_enu[3] = {-0.6, 0, 0.8};
    hand_air_off(sun_enu);
    for (int upper = 0; upper < 2; upper++) {
        Picture picture = shoot_edge(upper, 0.9 * hand_emitted(BAND_LWIR), 0.8 * hand_emitted(BAND_MWIR));
        check_edge(&picture, upper, "ground");
        picture = shoot_edge(upper, 0, 0);
        check_edge(&picture, upper, "black sky");
    }
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_show_the_optics),
    };
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
