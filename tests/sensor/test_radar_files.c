/* Files of a radar (OUT/radar) of a measurement made by hand: profile, map, pictures and scan, against values on paper;
 * the greys of pictures are 255 times (decibels - lowest) / (highest - lowest), the lowest 5 dB below the noise. */
#include "tests/check.h"

#include "sensor/instruments/radar.h"
#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/images/image_file.h"

enum { rows = 4, columns = 6, plot_rows = 96, again = 256 / rows, positions = 2, azimuths = 3 };

static char           folder[temp_path_size];
static double complex cell[interval_channels * rows * columns], profile[2 * columns];
static double         profile_w[columns], mti_w[columns], power_w[positions * columns], sharp_w[azimuths * columns];
static float          resolution_m[azimuths * columns], view_w[2] = {1e-9f, NAN}, view_sharp_w[2] = {NAN, 1e-10f};
static uint8_t        sharpened[azimuths * columns];

/* Noise of 1e-12 W in a cell, 4e-12 W in a pulse; echoes 30, 60 and 10 dB above that of a cell, and a profile whose
 * peak stands 20 dB above that of a pulse. */
static void fill(RadarFrame *r, RadarSector *s, RadarPreset *preset)
{
    *preset = (RadarPreset){.name = "by_hand", .transmits_h = true, .mti_rows = 3};
    preset->wave.samples = columns, preset->wave.pulses = rows;
    for (int c = 0; c < interval_channels; c++)
        for (int i = 0; i < rows * columns; i++) cell[c * rows * columns + i] = (double)(c + 1) * 1e-7 * I;
    cell[0 * columns + 1] = sqrt(1e-9), cell[2 * columns + 3] = sqrt(1e-6) * I;
    cell[3 * columns + 5] = sqrt(5e-12) + sqrt(5e-12) * I;
    for (int x = 0; x < columns; x++) {
        profile[x] = (double)x + 0.5 * I, profile[columns + x] = -(double)x * I;
        profile_w[x] = x == 4 ? 4e-10 : 4e-12 * pow(10, -0.5), mti_w[x] = x + 7;
    }
    *s = (RadarSector){.plan = {.positions = positions, .step_rad = 2 * rad_per_deg, .interval_s = 0.032},
                       .columns = columns,
                       .noise_w = 1e-12,
                       .sharp_noise_w = 1e-13,
                       .power_w = power_w,
                       .azimuths = azimuths,
                       .azimuth_step_rad = 1.5 * rad_per_deg,
                       .sharp_w = sharp_w,
                       .resolution_m = resolution_m,
                       .sharpened = sharpened,
                       .width = 2,
                       .height = 1,
                       .view_w = view_w,
                       .view_sharp_w = view_sharp_w};
    for (int i = 0; i < positions * columns; i++) power_w[i] = (i + 1) * 1e-12;
    for (int i = 0; i < azimuths * columns; i++) sharp_w[i] = (i + 1) * 1e-13, resolution_m[i] = (float)i;
    sharpened[1 * columns + columns / 2] = 1;
    *r = (RadarFrame){.preset = preset,
                      .reference_m = 1000,
                      .map = {rows, columns, 2.5, 0.5, 0.25, cell},
                      .profile = profile,
                      .profile_w = profile_w,
                      .mti_w = mti_w,
                      .receiver = {.noise_w = 4e-12},
                      .scan = s};
}

static const char *file(const char *ending)
{
    static char path[frame_path_size];
    snprintf(path, sizeof path, "%s/radar/000007%s", folder, ending);
    return path;
}

static int write_all(void **state)
{
    (void)state;
    static RadarFrame  radar;
    static RadarSector sector;
    static RadarPreset preset;
    Consumer          *consumer;
    Frame             *frame = calloc(1, sizeof *frame);
    const Config       config = config_default();
    CHECK(frame && temp_folder(folder));
    fill(&radar, &sector, &preset);
    frame->number = 7;
    frame->outputs = 1;
    frame->output[0] = (FrameOutput){.name = "radar", .kind = &radar_kind, .record = &radar};
    CHECK(consume_radar(&consumer, &(PictureFiles){.out = folder, .config = &config}) == STATUS_OK);
    CHECK(consumer->begin(consumer) == STATUS_OK && consumer->put(consumer, frame) == STATUS_OK);
    CHECK(consumer->close(consumer) == STATUS_OK);
    free(frame);
    return 0;
}

static int remove_all(void **state)
{
    (void)state;
    char command[temp_path_size + 16];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static void the_profile_in_columns(void **state)
{
    (void)state;
    char  *text;
    size_t octets;
    CHECK(text_read_file(&text, &octets, "test", file(".csv"), 1 << 20) == STATUS_OK);
    CHECK(strstr(text, "by_hand") && strstr(text, "polarisation (h)") && strstr(text, "canceller of 3"));
    /* the middle of six stands at the reference: 1000 m + 1 x 2.5 m is column 4 */
    char *line = strstr(text, "\n1002.5000,");
    CHECK(line && strstr(text, "\n992.5000,") && !strstr(text, "\n1007.5000,"));
    double v[6];
    CHECK(sscanf(line, "\n1002.5000,%lf,%lf,%lf,%lf,%lf,%lf\n", &v[0], &v[1], &v[2], &v[3], &v[4], &v[5]) == 6);
    const double want[6] = {4e-10, 4, 0.5, 0, -4, 11};
    for (int k = 0; k < 6; k++) CHECK_NEAR(v[k], want[k], 1e-12);
    free(text);
}

static void the_map_channel_by_channel(void **state)
{
    (void)state;
    static const char *const name[] = {"sum", "right", "down", "cross"};
    float                    value[rows * columns];
    double                   number;
    char                     plane[16], unit[32];
    for (int c = 0; c < interval_channels; c++)
        for (int part = 0; part < 2; part++) {
            snprintf(plane, sizeof plane, "%s_%s", name[c], part ? "im" : "re");
            CHECK(image_read_f32(value, file(".exr"), plane) == STATUS_OK);
            CHECK((double)value[4] == (double)(float)(part ? (c + 1) * 1e-7 : 0));
            if (c == 0) CHECK((double)value[columns + columns + 3] == (double)(part ? 1e-3f : 0));
        }
    CHECK(image_read_string(unit, sizeof unit, file(".exr"), "unit") && strcmp(unit, "sqrt(W)") == 0);
    CHECK(image_read_number(&number, file(".exr"), "metre_per_column") && (number == 2.5));
    CHECK(image_read_number(&number, file(".exr"), "mps_per_row") && (number == 0.5));
    CHECK(image_read_number(&number, file(".exr"), "noise_w"));
    CHECK_NEAR(number, 1e-12, 1e-20); /* of a cell: a quarter of a sample's */
}

/* From -125 dBW, 5 dB below the noise of -120, to the strongest, -60. */
static void the_picture_in_decibels(void **state)
{
    (void)state;
    static uint8_t grey[(plot_rows + again * rows) * columns];
    ImageInfo      info;
    CHECK(image_info(&info, file(".png")) == STATUS_OK);
    CHECK(info.width == columns && info.height == plot_rows + again * rows && info.channels == 1 && info.bits == 8);
    CHECK(image_read_png(grey, file(".png")) == STATUS_OK);
    static const struct {
        int    row, column;
        double db;
    } echo[] = {{0, 1, -90}, {2, 3, -60}, {3, 5, -110}, {1, 2, -125}};
    for (int k = 0; k < 4; k++)
        for (int y = 0; y < again; y += again - 1) {
            const int found = grey[(plot_rows + echo[k].row * again + y) * columns + echo[k].column];
            CHECK_NEAR(found, 255 * (echo[k].db + 125) / 65, 0.51);
        }
    /* The profile: 10 log10(4 x 1e-12) - 5 dB = -119 dBW at the foot, 45 dB more at the top; 4e-10 W is 25 dB above the
     * foot. What lies at the foot has no column. The last row of the plot stays black. */
    int high[columns];
    for (int x = 0; x < columns; x++) {
        high[x] = 0;
        for (int y = 0; y < plot_rows; y++) high[x] += grey[y * columns + x] == 200;
        CHECK(grey[(plot_rows - 1) * columns + x] == 0);
    }
    CHECK_NEAR(high[4], (plot_rows - 2) * 25.0 / 45 - 1, 1);
    CHECK(high[0] == 0 && high[5] == 0);
}

/* Rows are ranges, the farthest on top; columns are azimuths. */
static void the_scan_as_an_image(void **state)
{
    (void)state;
    float  value[azimuths * columns];
    double number;
    CHECK(image_read_f32(value, file("_scan.exr"), "Y") == STATUS_OK);
    CHECK(value[0] == (float)(columns * 1e-12) && value[1] == (float)(2 * columns * 1e-12));
    CHECK(value[(columns - 1) * positions] == 1e-12f &&
          value[(columns - 1) * positions + 1] == (float)((columns + 1) * 1e-12));
    CHECK(image_read_number(&number, file("_scan.exr"), "first_azimuth_deg"));
    CHECK_NEAR(number, -2, 1e-9); /* the second of two positions is ahead */
    CHECK(image_read_number(&number, file("_scan.exr"), "azimuth_step_deg"));
    CHECK_NEAR(number, 2, 1e-9);
    CHECK(image_read_f32(value, file("_dbs.exr"), "resolution_m") == STATUS_OK);
    CHECK(value[0] == columns - 1 && value[(columns - 1) * azimuths + 2] == 2 * columns);
    CHECK(image_read_f32(value, file("_dbs.exr"), "sharpened") == STATUS_OK);
    for (int y = 0; y < columns; y++)
        for (int x = 0; x < azimuths; x++) CHECK((value[y * azimuths + x] == 1) == (x == 1 && y == columns / 2 - 1));
    CHECK(image_read_number(&number, file("_dbs.exr"), "first_azimuth_deg"));
    CHECK_NEAR(number, -2, 1e-9);
    CHECK(image_read_number(&number, file("_dbs.exr"), "azimuth_step_deg"));
    CHECK_NEAR(number, 1.5, 1e-9);
    CHECK(image_read_f32(value, file("_view.exr"), "scan") == STATUS_OK && value[0] == 1e-9f && isnan(value[1]));
    CHECK(image_read_f32(value, file("_view.exr"), "dbs") == STATUS_OK && isnan(value[0]) && value[1] == 1e-10f);

    /* 1e-9 W is 30 dB above the noise, 35 above black; 45 dB are white at least. Sky is black */
    uint8_t view[2];
    CHECK(image_read_png(view, file("_view_scan.png")) == STATUS_OK && view[1] == 0);
    CHECK_NEAR(view[0], 255 * 35.0 / 45, 0.51);
    CHECK(image_read_png(view, file("_view_dbs.png")) == STATUS_OK && view[0] == 0);
    CHECK_NEAR(view[1], 255 * 35.0 / 45, 0.51);
    static uint8_t wide[columns * 384];
    ImageInfo      info;
    CHECK(image_info(&info, file("_scan.png")) == STATUS_OK && info.width == 384 && info.height == columns);
    CHECK(image_read_png(wide, file("_scan.png")) == STATUS_OK);
    CHECK_NEAR(wide[191], 255 * (10 * log10(6) + 5) / 45, 0.51);
    CHECK_NEAR(wide[192], 255 * (10 * log10(12) + 5) / 45, 0.51);
    CHECK(image_info(&info, file("_dbs.png")) == STATUS_OK && info.width == 384 && info.height == columns);

    char  *text;
    size_t octets;
    double at[3];
    int    is;
    CHECK(text_read_file(&text, &octets, "test", file("_dbs.csv"), 1 << 20) == STATUS_OK);
    const char *line = strstr(text, "\n-0.5");
    CHECK(line && sscanf(line, "%lf,%lf,%lf,%d", &at[0], &at[1], &at[2], &is) == 4);
    /* azimuth 1 of 3: -2 + 1.5 degrees, in the position ahead (0 of -1, 0), at the middle range, cell 6 + 3 */
    CHECK_NEAR(at[0], -0.5, 1e-9);
    CHECK_NEAR(at[1], 0, 1e-12);
    CHECK(at[2] == columns + columns / 2 && is == 1);
    line = strstr(text, "\n-2.0");
    CHECK(line && sscanf(line, "%lf,%lf,%lf,%d", &at[0], &at[1], &at[2], &is) == 4);
    CHECK_NEAR(at[1], -0.032, 1e-12);
    CHECK(is == 0);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_profile_in_columns),
        cmocka_unit_test(the_map_channel_by_channel),
        cmocka_unit_test(the_picture_in_decibels),
        cmocka_unit_test(the_scan_as_an_image),
    };
    return cmocka_run_group_tests(tests, write_all, remove_all);
}
