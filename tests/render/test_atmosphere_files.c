/* The tables of the air spoilt: a small set of them, written here, is refused with file and line, and nothing crashes.
 */
#include "tests/check.h"
#include "render/air/atmosphere.h"

#include <sys/stat.h>
#include <unistd.h>

typedef struct SmallFile {
    const char *name, *text;
} SmallFile;

#define COLUMN_HEAD                                                                                                    \
    "height_m,extinction_b,scatter_b,extinction_g,scatter_g,extinction_r,scatter_r,extinction_nir,"                    \
    "scatter_nir,extinction_mwir,scatter_mwir,extinction_lwir,scatter_lwir\n"
#define COLUMN_ROWS "0,0.2,0.1,0.2,0.1,0.2,0.1,0.2,0.1,0.2,0.1,0.2,0.1\n20000,0.1,0,0.1,0,0.1,0,0.1,0,0.1,0,0.1,0\n"
#define PATHS                                                                                                          \
    "observer_m,target_m,range_m,depth_sun\n0,0,100,0.02\n0,0,1000,0.2\n0,9000,9000,1\n9000,0,9000,1\n"                \
    "9000,9000,100,0.01\n9000,9000,1000,0.1\n"
#define THERMAL                                                                                                        \
    "observer_m,target_m,range_m,depth_sun,depth_250k,depth_300k,thermal_w_m2_sr\n"                                    \
    "0,0,100,0.02,0.02,0.02,1\n0,0,1000,0.2,0.2,0.2,9\n0,9000,9000,1,1,1,20\n9000,0,9000,1,1,1,20\n"                   \
    "9000,9000,100,0.01,0.01,0.01,1\n"
#define SOLAR "visibility_m,water_mm,ground_m,sun_zenith_deg,direct_w_m2,diffuse_w_m2\n"
#define LIMB  "visibility_m,observer_m,place,mwir,lwir\n"
#define SIX   "b,g,r,nir,mwir,lwir\n"

static const SmallFile small_files[] = {
    {"bands.csv", "band,sun_top_w_m2\nb,187\ng,185\nr,159\nnir,376\nmwir,12.8\nlwir,1.1\n"},
    {"solar.csv", SOLAR "900,3,0,0,800,200\n9000,3,0,0,900,90\n900,3,0,80,200,40\n9000,3,0,80,400,30\n"},
    {"m/visibilities.csv", "visibility_m,longwave_down_w_m2\n10000,300\n"},
    {"m/temperature.csv", "height_m,temp_k\n0,288\n11000,217\n"},
    {"m/phase.csv", "height_m,angle_deg," SIX "0,0,9,9,9,9,9,9\n0,180,0.5,0.5,0.5,0.5,0.5,0.5\n"},
    {"m/clear/air.csv", COLUMN_HEAD COLUMN_ROWS},
    {"m/clear/paths_b.csv", PATHS},
    {"m/clear/paths_g.csv", PATHS},
    {"m/clear/paths_r.csv", PATHS},
    {"m/clear/paths_nir.csv", PATHS},
    {"m/clear/paths_mwir.csv", THERMAL},
    {"m/clear/paths_lwir.csv", THERMAL},
    {"m/10000/haze.csv", COLUMN_HEAD COLUMN_ROWS},
    {"m/10000/paths_b.csv", PATHS},
    {"m/10000/paths_g.csv", PATHS},
    {"m/10000/paths_r.csv", PATHS},
    {"m/10000/paths_nir.csv", PATHS},
    {"m/10000/paths_mwir.csv", THERMAL},
    {"m/10000/paths_lwir.csv", THERMAL},
    {"m/10000/sky_thermal.csv", "observer_m,zenith_deg,mwir,lwir\n0,0,0.4,6\n0,90,1,30\n"},
    {"m/10000/sun.csv", "observer_m,sun_zenith_deg,direct_b,direct_g,direct_r,direct_nir,direct_mwir,direct_lwir,"
                        "diffuse_b,diffuse_g,diffuse_r,diffuse_nir,diffuse_mwir,diffuse_lwir\n"
                        "0,0,90,90,90,200,8,0.7,60,40,30,50,0.1,0.01\n0,85,9,9,9,20,1,0.1,6,4,3,5,0.01,0\n"},
    {"m/10000/sky_scattered.csv", "observer_m,zenith_deg,sun_zenith_deg,rel_azimuth_deg," SIX
                                  "0,0,0,0,9,8,7,6,0.1,0.01\n0,80,0,0,9,8,7,6,0.1,0.01\n"},
    {"m/10000/scattered.csv", "observer_m,zenith_deg,range_m,sun_zenith_deg,rel_azimuth_deg," SIX
                              "0,0,100,0,0,1,1,1,1,0.1,0\n0,0,100,0,180,1,1,1,1,0.1,0\n0,0,900,0,0,2,2,2,2,0.2,0\n"
                              "0,0,900,0,180,2,2,2,2,0.2,0\n0,180,50,0,0,1,1,1,1,0,0\n0,180,50,0,180,1,1,1,1,0,0\n"},
    {"m/limb.csv", LIMB "10000,0,0,1,1\n10000,0,2,1,1\n10000,9000,0,1.1,1\n10000,9000,2,0.9,1\n"},
};
enum { small_count = sizeof small_files / sizeof *small_files };

static char small_root[64];

static void write_small(int which, const char *text, size_t octets)
{
    char path[256];
    snprintf(path, sizeof path, "%s/atmosphere/%s", small_root, small_files[which].name);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(text, 1, octets, file) == octets && fclose(file) == 0);
}

static void restore_small(int which) { write_small(which, small_files[which].text, strlen(small_files[which].text)); }

static int make_small(void **state)
{
    (void)state;
    strcpy(small_root, "/tmp/pitviper-test-XXXXXX");
    if (channels_load() != STATUS_OK || !mkdtemp(small_root))
        return -1; /* the table of channels is the program's own */
    static const char *const folder[] = {"atmosphere", "atmosphere/m", "atmosphere/m/clear", "atmosphere/m/10000"};
    for (int i = 0; i < 4; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", small_root, folder[i]);
        if (mkdir(path, 0777) != 0) return -1;
    }
    for (int i = 0; i < small_count; i++) restore_small(i);
    setenv("PITVIPER_ETC", small_root, 1);
    log_set_sink(check_listen, NULL);
    return 0;
}

static int remove_small(void **state)
{
    (void)state;
    log_set_sink(NULL, NULL);
    unsetenv("PITVIPER_ETC");
    char path[256];
    for (int i = 0; i < small_count; i++) {
        snprintf(path, sizeof path, "%s/atmosphere/%s", small_root, small_files[i].name);
        remove(path);
    }
    static const char *const folder[] = {"/atmosphere/m/10000", "/atmosphere/m/clear", "/atmosphere/m", "/atmosphere",
                                         ""};
    for (int i = 0; i < 5; i++) {
        snprintf(path, sizeof path, "%s%s", small_root, folder[i]);
        rmdir(path);
    }
    return 0;
}

static int small_index(const char *name)
{
    for (int i = 0; i < small_count; i++)
        if (strcmp(small_files[i].name, name) == 0) return i;
    fail_msg("no file %s", name);
    return -1;
}

/* First wrong thing first: the last line logged is the model's, so the one before is kept. */
static char first_said[1024];
static void listen_first(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level == LOG_ERROR && !first_said[0]) snprintf(first_said, sizeof first_said, "%s", line);
}

static void refuses_and_says_where(void **state)
{
    (void)state;
    static const struct {
        const char *file, *text, *said;
    } bad[] = {
        {"bands.csv", "band,sun_top_w_m2\nb,187\nb,187\n", "bands.csv:3"},
        {"bands.csv", "band,sun_top_w_m2\nb,187\ng,185\nr,159\nnir,376\nmwir,12.8\n", "lwir"},
        {"bands.csv", "band,top\nb,187\n", "sun_top_w_m2"},
        {"solar.csv", SOLAR "900,3,0,0,800,200\n9000,3,0,0,900,90\n900,3,0,80,200,40\n",
         "solar.csv:4: a point is missing"},
        {"solar.csv", SOLAR "900,3,0,0,800,200\n900,3,0,0,800,200\n", "solar.csv:3: this point is there twice"},
        {"solar.csv", SOLAR "900,3,0,0,0,200\n", "solar.csv:2: column direct_w_m2"},
        {"solar.csv", SOLAR "900,3,0,91,800,200\n", "sun_zenith_deg"},
        {"solar.csv", SOLAR "900,3,0,0,800,200\n900,3,0,1e-9,800,200\n",
         "two values of sun_zenith_deg are nearly the same"},
        {"solar.csv", SOLAR, "no rows"},
        {"m/visibilities.csv", "visibility_m,longwave_down_w_m2\n10000,nan\n", "visibilities.csv:2"},
        {"m/visibilities.csv", "visibility_m,longwave_down_w_m2\n10000,300\n20000,290\n", "20000/haze.csv"},
        {"m/visibilities.csv", "visibility_m,longwave_down_w_m2\n", "no rows"},
        {"m/temperature.csv", "height_m,temp_k\n0,288\n0,289\n", "temperature.csv:3: this point is there twice"},
        {"m/temperature.csv", "height_m,temp_k\n0,-288\n", "temp_k"},
        {"m/phase.csv", "height_m,angle_deg," SIX "0,0,9,9,9,9,9,9\n90,180,1,1,1,1,1,1\n",
         "phase.csv:3: a point is missing"},
        {"m/clear/air.csv", COLUMN_HEAD "100,1,1,1,1,1,1,1,1,1,1,1,1\n200,1,1,1,1,1,1,1,1,1,1,1,1\n", "from 0 upwards"},
        {"m/clear/air.csv", COLUMN_HEAD "0,0,1,1,1,1,1,1,1,1,1,1,1\n", "air.csv:2"},
        {"m/clear/paths_b.csv", "observer_m,target_m,range_m,depth_sun\n0,0,100,0.02\n0,9000,9000,1\n9000,0,900,1\n",
         "paths_b.csv:4: range_m 900 is less"},
        {"m/clear/paths_b.csv", "observer_m,target_m,range_m,depth_sun\n0,0,100,0.02\n0,9000,9000,1\n9000,9000,100,1\n",
         "no path: observer_m=9000 target_m=0"},
        {"m/clear/paths_b.csv", "observer_m,target_m,range_m,depth_sun\n0,0,100,0.02\n0,0,100,0.02\n",
         "paths_b.csv:3: this path is there twice"},
        {"m/clear/paths_b.csv", "observer_m,target_m,range_m,depth_sun\n0,0,100,-1\n",
         "paths_b.csv:2: column depth_sun"},
        {"m/clear/paths_b.csv", "observer_m,target_m,range_m\n0,0,100\n", "depth_sun"},
        {"m/clear/paths_mwir.csv", PATHS, "depth_<kelvin>k"},
        {"m/10000/paths_lwir.csv", "observer_m,target_m,range_m,depth_sun,depth_hotk,thermal_w_m2_sr\n0,0,100,1,1,1\n",
         "depth_hotk"},
        {"m/10000/paths_lwir.csv", "observer_m,target_m,range_m,depth_sun,depth_300k\n0,0,100,1,1\n",
         "thermal_w_m2_sr"},
        {"m/10000/sun.csv", "observer_m,sun_zenith_deg\n0,0\n", "direct_b"},
        {"m/10000/scattered.csv",
         "observer_m,zenith_deg,range_m,sun_zenith_deg,rel_azimuth_deg," SIX
         "0,0,100,0,0,1,1,1,1,0.1,0\n0,0,100,0,180,1,1,1,1,0.1,0\n0,0,900,0,0,2,2,2,2,0.2,0\n",
         "scattered.csv:4"},
        {"m/10000/sky_thermal.csv", "observer_m,zenith_deg,mwir,lwir\n0,0,0.4\n", "sky_thermal.csv:2"},
        {"m/limb.csv", LIMB "10000,0,0,1,1\n10000,0,2,1,1\n10000,9000,2,1,1\n", "limb.csv:4: a point is missing"},
        {"m/limb.csv", LIMB "10000,0,2.5,1,1\n", "limb.csv:2: column place"},
        {"m/limb.csv", LIMB "10000,0,0,0,1\n", "limb.csv:2: column mwir"},
    };
    log_set_sink(listen_first, NULL);
    Atmosphere *model = NULL;
    CHECK(atmosphere_open(&model, "m") == STATUS_OK); /* whole as it stands */
    atmosphere_close(model);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const int which = small_index(bad[i].file);
        write_small(which, bad[i].text, strlen(bad[i].text));
        model = NULL;
        first_said[0] = 0;
        const Status status = atmosphere_open(&model, "m");
        if (status == STATUS_OK || model || !strstr(first_said, bad[i].said))
            fail_msg("case %zu: %s, said \"%s\", want \"%s\"", i, status_name(status), first_said, bad[i].said);
        restore_small(which);
    }
    static const char *const names[] = {"", "nothing", "../m", "m/../m", "M", "a name"};
    for (int i = 0; i < 6; i++) {
        first_said[0] = 0;
        CHECK(atmosphere_open(&model, names[i]) != STATUS_OK && !model && first_said[0]);
    }
    log_set_sink(check_listen, NULL);
}

/* A model of one's own has the air of its tables under any weather, and the vapour that its ground.csv says. */
static void its_own_air_stays(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double      kg_m3; /* NAN: refused */
    } of[] = {{"vapour_g_m3\n9.5\n", 9.5e-3}, {"vapour_g_m3\n0\n", 0},    {"vapour_g_m3\n9.5\n10\n", NAN},
              {"vapour_g_m3\n201\n", NAN},    {"vapour_g_m3\n-1\n", NAN}, {"vapour\n9\n", NAN}};
    Atmosphere       *model = NULL;
    const Atmosphere *there = NULL;
    Arena            *arena = arena_create();
    const AirState    humid = {10000, 308, 0.033};
    char              path[256];
    CHECK(arena && atmosphere_open(&model, "m") == STATUS_OK);
    CHECK(!atmosphere_follows_weather(model) && isnan(atmosphere_vapour_kg_m3(model)));
    CHECK(atmosphere_in(&there, model, &humid, ~0u, arena) == STATUS_OK && there == model);
    atmosphere_close(model);
    snprintf(path, sizeof path, "%s/atmosphere/m/ground.csv", small_root);
    for (int i = 0; i < 6; i++) {
        FILE *file = fopen(path, "wb");
        CHECK(file && fputs(of[i].text, file) >= 0 && fclose(file) == 0);
        model = NULL;
        const Status status = atmosphere_open(&model, "m");
        CHECK((status == STATUS_OK) == isfinite(of[i].kg_m3));
        if (status == STATUS_OK) CHECK_NEAR(atmosphere_vapour_kg_m3(model), of[i].kg_m3, 1e-12);
        atmosphere_close(model);
    }
    unlink(path);
    arena_destroy(arena);
}

/* A folder of its own, of haze, sun and the sky's light alone, or of all with other heights, ranges and azimuths. */
typedef struct Beside {
    const char *name, *text;
} Beside;
#define THICK_ROWS                                                                                                     \
    "0,1,0.9,1,0.9,1,0.9,1,0.9,1,0.9,1,0.9\n1000,1,0.9,1,0.9,1,0.9,1,0.9,1,0.9,1,0.9\n"                                \
    "20000,0.1,0,0.1,0,0.1,0,0.1,0,0.1,0,0.1,0\n"
#define THICK_PATHS                                                                                                    \
    "observer_m,target_m,range_m,depth_sun\n0,0,200,0.3\n0,0,5000,5\n0,8000,8000,4\n"                                  \
    "8000,0,8000,4\n8000,8000,300,0.05\n"
#define THICK_THERMAL                                                                                                  \
    "observer_m,target_m,range_m,depth_sun,depth_280k,thermal_w_m2_sr\n0,0,200,0.3,0.3,1\n"                            \
    "0,0,5000,5,5,9\n"                                                                                                 \
    "0,8000,8000,4,4,9\n8000,0,8000,4,4,9\n8000,8000,300,0.05,0.05,1\n"
static const Beside thick[] = {
    {"haze.csv", COLUMN_HEAD THICK_ROWS},
    {"sky_thermal.csv", "observer_m,zenith_deg,mwir,lwir\n0,0,0.5,7\n0,60,0.6,9\n0,90,1,30\n"},
    {"sun.csv", "observer_m,sun_zenith_deg,direct_b,direct_g,direct_r,direct_nir,direct_mwir,direct_lwir,"
                "diffuse_b,diffuse_g,diffuse_r,diffuse_nir,diffuse_mwir,diffuse_lwir\n"
                "0,0,20,20,20,90,7,0.6,90,70,60,90,0.2,0.02\n0,85,1,1,1,5,0.5,0.05,6,4,3,5,0.01,0\n"},
    {"paths_b.csv", THICK_PATHS},
    {"paths_g.csv", THICK_PATHS},
    {"paths_r.csv", THICK_PATHS},
    {"paths_nir.csv", THICK_PATHS},
    {"paths_mwir.csv", THICK_THERMAL},
    {"paths_lwir.csv", THICK_THERMAL},
    {"sky_scattered.csv", "observer_m,zenith_deg,sun_zenith_deg,rel_azimuth_deg," SIX "0,10,0,0,5,4,3,2,0.1,0.01\n"
                          "0,10,60,0,5,4,3,2,0.1,0.01\n"},
    {"scattered.csv", "observer_m,zenith_deg,range_m,sun_zenith_deg,rel_azimuth_deg," SIX
                      "0,0,300,0,90,3,3,3,3,0.1,0\n0,180,50,0,90,1,1,1,1,0,0\n"},
};
enum { thick_light = 3, thick_all = sizeof thick / sizeof *thick };

static void write_thick(int count)
{
    char path[256];
    snprintf(path, sizeof path, "%s/atmosphere/m/4000", small_root);
    mkdir(path, 0777);
    for (int i = 0; i < thick_all; i++) {
        snprintf(path, sizeof path, "%s/atmosphere/m/4000/%s", small_root, thick[i].name);
        remove(path);
        if (i >= count) continue;
        FILE *file = fopen(path, "wb");
        CHECK(file && fputs(thick[i].text, file) >= 0 && fclose(file) == 0);
    }
    if (count > 0) return;
    snprintf(path, sizeof path, "%s/atmosphere/m/4000", small_root);
    rmdir(path);
}

/* Two visibilities of which one may lack paths and scattered light, or has them at other points: haze of either and of
 * what lies between, by hand. */
static void visibilities_of_any_shape(void **state)
{
    (void)state;
    static const char both[] = "visibility_m,longwave_down_w_m2\n10000,300\n4000,320\n";
    const int         list = small_index("m/visibilities.csv");
    const AirPath     path = {0, 0, 200, 0.5, 1};
    write_small(list, both, sizeof both - 1);
    for (int whole = 0; whole < 2; whole++) {
        write_thick(whole ? thick_all : thick_light);
        static const double visibility_m[] = {1000, 4000, 6000, 10000, 30000};
        double              last = 0;
        for (int v = 0; v < 5; v++) {
            Atmosphere *all = NULL, *one = NULL;
            CHECK(atmosphere_open(&all, "m") == STATUS_OK);
            CHECK(atmosphere_open_at(&one, "m", visibility_m[v]) == STATUS_OK);
            for (int b = 0; b < AIR_BAND_COUNT; b++) {
                PathAir a, c;
                SkyAir  sky;
                SunAir  sun;
                atmosphere_path(&a, all, visibility_m[v], (AirBand)b, &path, 300);
                atmosphere_path(&c, one, visibility_m[v], (AirBand)b, &path, 300);
                atmosphere_sky(&sky, one, visibility_m[v], (AirBand)b, 0, 1, 0.5, 1);
                atmosphere_sun(&sun, one, visibility_m[v], (AirBand)b, 0, 0.5);
                CHECK_NEAR(a.transmittance, c.transmittance, 0.01);
                CHECK(isfinite(a.scattered_w_m2_sr) && isfinite(c.thermal_w_m2_sr) && isfinite(sky.scattered_w_m2_sr));
                CHECK(sun.direct_normal_w_m2 > 0 && isfinite(sun.diffuse_horizontal_w_m2));
                if (b > 0) continue;
                CHECK(whole && v < 4 ? c.transmittance > last : c.transmittance >= last - 1e-6);
                last = c.transmittance;
                /* m/10000 is clear air alone: depth 0.04 in 200 m. m/4000: its own row, or its haze, 1/km, at 0 m */
                if (v == 1) CHECK_NEAR(-log(c.transmittance), whole ? 0.3 : 0.04, whole ? 1e-6 : 0.2);
                if (v == 3) CHECK_NEAR(-log(c.transmittance), 0.0386, 0.003);
            }
            atmosphere_close(all);
            atmosphere_close(one);
        }
    }
    write_thick(0);
    restore_small(list);
}

/* Bytes and lines changed, lost and doubled: refused with a reason, or read and then of finite answers. */
static void survives_any_spoiling(void **state)
{
    (void)state;
    static const char *const word_in[] = {"nan", "1e999", "-1", "", ",", "\n", "1e308", "#", "\"", "0", "1e-300"};
    int                      opened = 0, refused = 0;
    for (int which = 0; which < small_count; which++) {
        const char  *text = small_files[which].text;
        const size_t octets = strlen(text);
        for (uint32_t k = 0; k < 60; k++) {
            uint32_t r[4];
            random_u32x4(r, (uint32_t[4]){k, (uint32_t)which, 0, 0}, (uint32_t[2]){7, 7});
            char         spoilt[4096];
            const size_t at = r[0] % octets, length = 1 + r[1] % (k % 2 ? 3 : 60);
            const size_t end = at + length < octets ? at + length : octets;
            size_t       n = 0;
            memcpy(spoilt, text, at);
            n = at;
            if (k % 3 == 0) { /* some of it gone */
                memcpy(spoilt + n, text + end, octets - end);
                n += octets - end;
            } else if (k % 3 == 1) { /* twice */
                memcpy(spoilt + n, text + at, end - at);
                n += end - at;
                memcpy(spoilt + n, text + at, octets - at);
                n += octets - at;
            } else { /* something else */
                const char *word = word_in[r[2] % 11];
                memcpy(spoilt + n, word, strlen(word));
                n += strlen(word);
                memcpy(spoilt + n, text + end, octets - end);
                n += octets - end;
            }
            write_small(which, spoilt, n);
            Atmosphere *model = NULL;
            check_said[0] = 0;
            if (atmosphere_open(&model, "m") != STATUS_OK) {
                CHECK(!model && check_said[0]);
                refused++;
                continue;
            }
            opened++;
            SunAir solar;
            atmosphere_solar(&solar, model, &(SolarAir){3000, 3, 100}, 0.5);
            CHECK(solar.direct_normal_w_m2 >= 0 && solar.direct_normal_w_m2 <= 1361);
            CHECK(solar.diffuse_horizontal_w_m2 >= 0 && solar.diffuse_horizontal_w_m2 <= 1361);
            for (int b = 0; b < AIR_BAND_COUNT; b++) {
                const AirPath path = {100, 3000, 7000, 0.5, 1};
                PathAir       air;
                SkyAir        sky;
                SunAir        sun;
                atmosphere_path(&air, model, 10000, (AirBand)b, &path, 300);
                atmosphere_sky(&sky, model, 10000, (AirBand)b, 0, 1, 0.5, 1);
                atmosphere_sun(&sun, model, 10000, (AirBand)b, 0, 0.5);
                CHECK(air.transmittance >= 0 && air.transmittance <= 1 && isfinite(sun.direct_normal_w_m2));
                CHECK(!isnan(air.thermal_w_m2_sr) && !isnan(air.scattered_w_m2_sr));
                CHECK(!isnan(sky.thermal_w_m2_sr) && !isnan(sky.scattered_w_m2_sr));
            }
            atmosphere_close(model);
        }
        restore_small(which);
    }
    printf("  spoilt tables: %d refused, %d read\n", refused, opened);
    CHECK(refused > 500 && opened > 50); /* both ways are walked */
}

/* A set by weather. Distances by hand: |dT| / 5 + |ln(vapour ratio)| / 0.18232. */
static void a_set_has_the_nearest(void **state)
{
    (void)state;
    char folder[] = "/tmp/test_set_XXXXXX", path[64], want[96], got[256];
    CHECK(mkdtemp(folder) != NULL);
    snprintf(path, sizeof path, "%s/weathers.csv", folder);
    FILE *file = fopen(path, "w");
    CHECK(file != NULL &&
          fputs("vapour_g_m3,folder,air_temp_k\n2,dry,300\n13,own,296\n19,wet,310\n0,frost,250\n", file) >= 0 &&
          fclose(file) == 0);
    static const struct {
        double      temp_k, g_m3;
        const char *name;
    } row[] = {
        {300, 15.2, "own"},   /* 0.8 + 0.86; dry 11.1, wet 2 + 1.22 */
        {304, 15.2, "wet"},   /* 1.2 + 1.22; own 1.6 + 0.86 = 2.46 */
        {303.6, 15.2, "own"}, /* 1.52 + 0.86 = 2.38; wet 1.28 + 1.22 = 2.50 */
        {300, 5.05, "dry"},   /* 5.08; own 0.8 + 5.19 = 5.99 */
        {300, 6, "own"},      /* 0.8 + 4.24 = 5.04; dry 6.03 */
        {251, 0, "frost"},    {249, 1e-3, "frost"},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        CHECK(atmosphere_nearest(got, sizeof got, folder, row[i].temp_k, 1e-3 * row[i].g_m3) == STATUS_OK);
        snprintf(want, sizeof want, "%s/%s", folder, row[i].name);
        assert_string_equal(got, want);
    }
    CHECK(atmosphere_nearest(got, sizeof got, folder, NAN, NAN) == STATUS_BAD_VALUE);
    CHECK(atmosphere_nearest(got, 20, folder, 300, 0.01) == STATUS_BAD_VALUE); /* no room */
    Atmosphere *none = NULL;
    CHECK(atmosphere_open_at(&none, folder, 23000) == STATUS_BAD_VALUE && none == NULL);
    static const char *const wrong[] = {"",
                                        "folder,air_temp_k,vapour_g_m3\n",
                                        "folder,air_temp_k\na,300\n",
                                        "folder,air_temp_k,vapour_g_m3\n../a,300,1\n",
                                        "folder,air_temp_k,vapour_g_m3\n..,300,1\n",
                                        "folder,air_temp_k,vapour_g_m3\na,27,1\n",
                                        "folder,air_temp_k,vapour_g_m3\n,300,1\n"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        file = fopen(path, "w");
        CHECK(file != NULL && fputs(wrong[i], file) >= 0 && fclose(file) == 0);
        CHECK(atmosphere_nearest(got, sizeof got, folder, 300, 0.01) == STATUS_BAD_VALUE);
    }
    CHECK(remove(path) == 0);
    /* without it, and of a name, the model is itself */
    CHECK(atmosphere_nearest(got, sizeof got, folder, NAN, NAN) == STATUS_OK && strcmp(got, folder) == 0);
    CHECK(atmosphere_nearest(got, sizeof got, "us1976", NAN, NAN) == STATUS_OK && strcmp(got, "us1976") == 0);
    CHECK(rmdir(folder) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_set_has_the_nearest),
        cmocka_unit_test_setup_teardown(refuses_and_says_where, make_small, remove_small),
        cmocka_unit_test_setup_teardown(its_own_air_stays, make_small, remove_small),
        cmocka_unit_test_setup_teardown(visibilities_of_any_shape, make_small, remove_small),
        cmocka_unit_test_setup_teardown(survives_any_spoiling, make_small, remove_small),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
