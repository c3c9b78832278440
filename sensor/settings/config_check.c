/* sensor/settings/config_check.c: checks of settings: texts with a grammar of their own, bands and times in a
 * recording; and what involves several settings. */
#include "sensor/settings/config_private.h"

#include "dis/cigi/cigi_link.h"
#include "dis/head/head_link.h"
#include "dis/pdu/pdu.h"
#include "dis/capture/recorder.h"
#include "pitviper_channels.h"
#include "sensor/settings/aim_offset.h"
#include "sensor/settings/projector_choice.h"
#include "sensor/settings/publish_choice.h"
#include "terrain/ground/placed.h"

/* ---- bands: with further channels chosen in their places ------------------------------------------ */

/* The band of this name: optical, mwir, lwir or radar; -1: it is none. */
static int band_named(const char *name, size_t length)
{
    static const char *const names[BAND_COUNT] = {"optical", "mwir", "lwir", "radar"};
    for (int b = 0; b < BAND_COUNT; b++)
        if (strlen(names[b]) == length && strncmp(names[b], name, length) == 0) return b;
    return -1;
}

static bool no_bands(const char *text, const char *band, size_t length, const char *where)
{
    char further[256], word[64];
    snprintf(word, sizeof word, "%.*s", (int)length, band);
    WordMeant meant = word_meant(word);
    channels_list(further, sizeof further);
    word_consider_list(&meant, "optical|radar", '|');
    for (const char *at = further; *(at += strspn(at, ", "));) {
        char         one[64];
        const size_t n = strcspn(at, ", ");
        snprintf(one, sizeof one, "%.*s", (int)n, at);
        word_consider(&meant, one);
        at += n;
    }
    log_error(
        "config: %ssensor.bands: '%s' is not a list of optical, radar or channels of etc/channels.csv: %s; there is "
        "no '%s'%s",
        where, text, further, word, word_hint(&meant));
    return false;
}

/* Whether each band is named once: `lwir,lwir` is a slip. */
static bool named_once(const char *text, const char *where)
{
    for (const char *at = text; *at;) {
        const size_t length = strcspn(at, ",");
        for (const char *next = at + length; *next;) {
            next += *next == ',';
            const size_t other = strcspn(next, ",");
            if (other == length && length > 0 && strncmp(at, next, length) == 0) {
                log_error("config: %ssensor.bands: '%s': %.*s is named twice; name each band once", where, text,
                          (int)length, at);
                return false;
            }
            next += other;
        }
        at += length + (at[length] == ',');
    }
    return true;
}

static int band_of(const SpectralChannel *channel)
{
    return channel->place == SPECTRAL_NIR ? BAND_OPTICAL : channel->place == SPECTRAL_MWIR ? BAND_MWIR : BAND_LWIR;
}

/* Reads the set of bands, and the further channels that take the places of some. where: place of the setting in a file,
 * for messages; or "". */
static bool bands_parse(unsigned *bands, const SpectralChannel *further[BAND_COUNT], const char *text,
                        const char *where)
{
    *bands = 0;
    if (channels_load() != STATUS_OK || !named_once(text, where)) return false;
    for (const char *at = text; *at;) {
        const size_t           length = strcspn(at, ",");
        const SpectralChannel *channel = channel_named(at, length);
        const bool             standard = !channel || channel->standard;
        const int              found = standard ? band_named(at, length) : band_of(channel);
        if (found < 0) return no_bands(text, at, length, where);
        if (*bands >> found & 1) {
            const SpectralChannel *one = standard ? further[found] : channel;
            log_error("config: %ssensor.bands: '%s': %s takes the place of another that is named; one of them a run",
                      where, text, one ? one->name : "it");
            return false;
        }
        if (!standard) further[found] = channel;
        *bands |= 1u << found;
        at += length + (at[length] == ',');
    }
    if (*bands == 0) log_error("config: %ssensor.bands: no band is named; any of optical, mwir, lwir, radar", where);
    return *bands != 0;
}

bool config_bands_check(const char *text, const char *where)
{
    const SpectralChannel *further[BAND_COUNT] = {NULL};
    unsigned               bands;
    return bands_parse(&bands, further, text, where);
}

bool config_bands_choose(unsigned *bands, const char *text)
{
    const SpectralChannel *further[BAND_COUNT] = {NULL};
    if (!bands_parse(bands, further, text, "")) return false;
    channels_standard();
    for (int b = 0; b < BAND_COUNT; b++)
        if (further[b]) channel_choose(further[b]);
    return true;
}

/* ---- times in a recording ------------------------------------------------------------------------ */

static bool span_parse(double *number, char *kind, const char *text)
{
    if (!text_to_double(number, text)) return false;
    *kind = *text == '+' || *text == '-' ? *text : ' ';
    return true;
}

bool config_span_good(const char *text)
{
    double number;
    char   kind;
    return !*text || span_parse(&number, &kind, text);
}

double config_span_time_s(const char *text, double first_s, double last_s)
{
    double number;
    char   kind;
    if (!span_parse(&number, &kind, text)) return NAN;
    return number + (kind == '+' ? first_s : kind == '-' ? last_s : 0);
}

bool config_span_backward(const char *from, const char *to)
{
    double a, b;
    char   x, y;
    return span_parse(&a, &x, from) && span_parse(&b, &y, to) && x == y && a > b;
}

bool config_span_outside(const char *from, const char *to, double first_s, double last_s)
{
    const double from_s = config_span_time_s(from, first_s, last_s), to_s = config_span_time_s(to, first_s, last_s);
    /* a live node renders frames after the last report until the entities time out; --to may ask for them */
    const bool late = from_s > last_s + (to_s > last_s ? 60 : 0), early = to_s<first_s, backward = from_s> to_s;
    if (!late && !early && !backward) return false;
    char which[2 * sizeof((Config *)0)->exercise.from_s + 24];
    if (backward && !late && !early) snprintf(which, sizeof which, "--from %s is after --to %s", from, to);
    else
        snprintf(which, sizeof which,
                 late ? "--from %s is after its end"
                      : "--to %s is before its "
                        "start",
                 late ? from : to);
    log_error(
        "replay: %s: the recording runs from %.3f to %.3f s of exercise time, +0 to +%.3f from its start, -%.3f to "
        "-0 from its "
        "end",
        which, first_s, last_s, last_s - first_s, last_s - first_s);
    return true;
}

/* ---- checks that involve several settings ----------------------------------------------------------- */

/* Whether a store stands alone: it has all of the ground, so nothing else can be named beside it, and it is not fitted.
 */
static bool store_alone(const Config *config)
{
    const struct {
        const char *key;
        bool        set;
    } other[] = {{"elevation", *config->terrain.elevation},
                 {"cover", *config->terrain.cover},
                 {"orthophoto", *config->terrain.orthophoto},
                 {"spacing_m", config->terrain.spacing_m > 0},
                 {"place", *config->terrain.place}};
    if (!*config->terrain.store) return true;
    for (size_t k = 0; k < sizeof other / sizeof *other; k++)
        if (other[k].set) {
            log_error("config: terrain.store and terrain.%s exclude each other: the store has all of the ground; give "
                      "it to `pitviper terrain import` when the store is made, or leave terrain.store out",
                      other[k].key);
            return false;
        }
    if (config->terrain.ground == TERRAIN_GROUND_FIT) {
        log_error("config: terrain.ground: a terrain store is mapped read-only and cannot be led through the entities; "
                  "use clamp or trust, or terrain.elevation instead of terrain.store for a fit");
        return false;
    }
    return config_is_readable("terrain.store", config->terrain.store);
}

/* Checks levels and bits of detector, and that what overrides a sensor preset has one. */
static bool detector_good(const Config *config)
{
    bool good = true;
    if (config->detector.bits != 8 && config->detector.bits != 16) {
        log_error("config: %sdetector.bits: %d is not 8 or 16", config_where(config, "detector.bits"),
                  config->detector.bits);
        good = false;
    }
    if (!(config->detector.lwir_low_k < config->detector.lwir_high_k)) {
        log_error("config: %sdetector.lwir_low_k: %g is not below detector.lwir_high_k, %g K",
                  config_where(config, "detector.lwir_low_k"), config->detector.lwir_low_k,
                  config->detector.lwir_high_k);
        good = false;
    }
    if (!(config->detector.mwir_low_k < config->detector.mwir_high_k)) {
        log_error("config: %sdetector.mwir_low_k: %g is not below detector.mwir_high_k, %g K",
                  config_where(config, "detector.mwir_low_k"), config->detector.mwir_low_k,
                  config->detector.mwir_high_k);
        good = false;
    }
    static const char *const of_preset[] = {"detector.f_number",   "detector.obscuration", "detector.integration_ms",
                                            "detector.jitter_px",  "detector.bad_share",   "detector.ac_per_line",
                                            "detector.line_noise", "detector.smear",       "detector.raw"};
    for (size_t i = 0; i < sizeof of_preset / sizeof *of_preset; i++)
        if (strcmp(config->sensor.preset, "none") == 0 && !*config_sheet(config) &&
            config_given(config, of_preset[i])) {
            log_error("config: %s%s: overrides a sensor preset; choose one with sensor.preset or sensor.table",
                      config_where(config, of_preset[i]), of_preset[i]);
            good = false;
        }
    if (config_table_has_rows(config) && strcmp(config->sensor.preset, "none") == 0) {
        log_error("config: %ssensor.table: %s is a table of sensors; choose one of its rows with sensor.preset",
                  config_where(config, "sensor.table"), config->sensor.table);
        good = false;
    }
    return good;
}

/* Checks the place of ground that follows no exercise. */
static bool place_good(const Config *config)
{
    Geodetic    place;
    const char *text = config->terrain.place, *where = config_where(config, "terrain.place");
    if (!*text) return true;
    if (!landscape_place_parse(&place, text)) {
        log_error("config: %sterrain.place: '%s' is not latitude, longitude and height: -90 .. 90 and -180 .. 180 deg, "
                  "-500 .. 9000 m, for example 50.1,8.6,120",
                  where, text);
        return false;
    }
    if (*config->terrain.elevation || config->terrain.ground == TERRAIN_GROUND_FIT) {
        log_error("config: %sterrain.place: this ground follows from seed and place alone; leave terrain.%s out, or "
                  "terrain.place",
                  where, *config->terrain.elevation ? "elevation" : "ground: fit");
        return false;
    }
    return true;
}

/* Checks which keys of terrain exclude and which need one another. */
static bool terrain_good(const Config *config)
{
    bool good = store_alone(config) && place_good(config);
    if (!*config->terrain.elevation && config->terrain.spacing_m > 0 &&
        !(config->terrain.spacing_m >= 1 && config->terrain.spacing_m <= 30)) {
        log_error("config: %sterrain.spacing_m: %g is not 0 or 1 .. 30 m for synthetic terrain",
                  config_where(config, "terrain.spacing_m"), config->terrain.spacing_m);
        good = false;
    }
    if (!*config->terrain.elevation && !*config->terrain.store &&
        (*config->terrain.cover || *config->terrain.orthophoto)) {
        log_error("config: %sterrain.%s needs terrain.elevation: synthetic terrain does not match real land cover",
                  config_where(config, *config->terrain.cover ? "terrain.cover" : "terrain.orthophoto"),
                  *config->terrain.cover ? "cover" : "orthophoto");
        good = false;
    }
    const char *buildings = config->terrain.buildings;
    if (!strpbrk(buildings, "/.") && strcmp(buildings, "off") != 0 && strcmp(buildings, "invented") != 0) {
        WordMeant meant = word_meant(buildings);
        word_consider_list(&meant, "off|invented", '|');
        log_error("config: %sterrain.buildings: '%s' is neither off nor invented nor the path of a file: ./%s%s",
                  config_where(config, "terrain.buildings"), buildings, buildings, word_hint(&meant));
        good = false;
    }
    return good;
}

/* Checks publish.pairs, coco and planes: what they need of other keys. */
static bool products_good(const Config *config)
{
    bool       good = true;
    const bool pairs = config->publish.pairs != PUBLISH_PAIRS_OFF;
    if ((pairs || config->publish.coco) && !config->publish.files) {
        log_error("config: %spublish.%s: needs image files; set publish.files: true",
                  config_where(config, pairs ? "publish.pairs" : "publish.coco"), pairs ? "pairs" : "coco");
        good = false;
    }
    PlaneSet planes;
    if (!publish_planes_parse(&planes, config->publish.planes)) {
        char why[200], names[400] = "";
        publish_planes_why(why, sizeof why, config->publish.planes);
        for (int i = 0, n = 0; publish_planes_name(i) && n < (int)sizeof names; i++)
            n += snprintf(names + n, sizeof names - (size_t)n, "%s, ", publish_planes_name(i));
        log_error(
            "config: %spublish.planes: '%s' is not all, none, or a list of %seach once, for example range,entity%s",
            config_where(config, "publish.planes"), config->publish.planes, names, why);
        good = false;
    }
    const PlaneSet of_woods = planes_named("instance", 8) | planes_named("cover", 5);
    if (planes != planes_named("", 0) && planes & of_woods && !config->terrain.woods) {
        log_error("config: %spublish.planes: instance and cover are of a world with plants: terrain.woods: on",
                  config_where(config, "publish.planes"));
        good = false;
    }
    return good;
}

/* Checks heat.facets, weather.day, sensor.mount and sensor.aim_offset. */
static bool scene_good(const Config *config)
{
    AimOffset offset;
    bool      good = true;
    if (!aim_offset_parse(&offset, config->sensor.aim_offset)) {
        log_error(
            "config: %ssensor.aim_offset: '%s' is not none, drawn, drawn W,H with shares in 0 .. 1, X,Y with shares "
            "in -0.5 .. 0.5, or X,Y deg with -60 .. 60",
            config_where(config, "sensor.aim_offset"), config->sensor.aim_offset);
        good = false;
    }
    if (config->heat.facets % 2 == 0) {
        log_error("config: %sheat.facets: %d is even; odd, 3 .. 17, so that one of them is level",
                  config_where(config, "heat.facets"), config->heat.facets);
        good = false;
    }
    if (!strpbrk(config->weather.day, "/.") && strcmp(config->weather.day, "clear") != 0 &&
        strcmp(config->weather.day, "constant") != 0) {
        WordMeant meant = word_meant(config->weather.day);
        word_consider_list(&meant, "clear|constant", '|');
        log_error("config: %sweather.day: '%s' is neither clear nor constant nor the path of a weather file: ./%s%s",
                  config_where(config, "weather.day"), config->weather.day, config->weather.day, word_hint(&meant));
        good = false;
    }
    if (!*config->sensor.mount) {
        log_error("config: %ssensor.mount: is empty; auto, or a part of the host such as `primary turret`",
                  config_where(config, "sensor.mount"));
        good = false;
    }
    return good;
}

/* Checks the ids, the times and the span of exercise. */
static bool exercise_good(const Config *config)
{
    DisEntityId id;
    double      unix_s;
    bool        good = true;
    if (*config->exercise.host && strcmp(config->exercise.host, "munition") != 0 &&
        strcmp(config->exercise.host, "observer") != 0 && !dis_entity_id_parse(&id, config->exercise.host)) {
        WordMeant meant = word_meant(config->exercise.host);
        word_consider_list(&meant, "munition|observer", '|');
        log_error("config: %sexercise.host: '%s' is neither site:application:entity, for example 1:3001:82, nor "
                  "munition nor observer%s",
                  config_where(config, "exercise.host"), config->exercise.host, word_hint(&meant));
        good = false;
    }
    if (*config->exercise.cigi && !cigi_link_recorded(config->exercise.cigi) &&
        !cigi_link_address_good(config->exercise.cigi)) {
        log_error("config: %sexercise.cigi: '%s' is not HOST:PORT with a numeric address, for example 127.0.0.1:8004, "
                  "nor `recorded`",
                  config_where(config, "exercise.cigi"), config->exercise.cigi);
        good = false;
    }
    if (*config->exercise.cigi && *config->exercise.host && strcmp(config->exercise.host, "observer") != 0) {
        log_error("config: %sexercise.cigi: the host moves the eye, so exercise.host: %s has none; leave that out",
                  config_where(config, "exercise.cigi"), config->exercise.host);
        good = false;
    }
    if (*config->exercise.head && !head_address_good(config->exercise.head)) {
        log_error(
            "config: %sexercise.head: '%s' is not ADDRESS:PORT with a numeric address, for example 127.0.0.1:5010",
            config_where(config, "exercise.head"), config->exercise.head);
        good = false;
    }
    if (*config->exercise.head && *config->exercise.cigi) {
        log_error("config: %sexercise.head: the host of exercise.cigi turns the eye already; leave one of them out",
                  config_where(config, "exercise.head"));
        good = false;
    }
    if (*config->exercise.aim && !dis_entity_id_parse(&id, config->exercise.aim)) {
        log_error("config: %sexercise.aim: '%s' is not site:application:entity, for example 1:3001:82",
                  config_where(config, "exercise.aim"), config->exercise.aim);
        good = false;
    }
    if (*config->exercise.utc && !text_to_unix_s(&unix_s, config->exercise.utc)) {
        log_error("config: %sexercise.utc: '%s' is not a time such as 2026-06-21T10:00:00Z, 1900 .. 2100",
                  config_where(config, "exercise.utc"), config->exercise.utc);
        good = false;
    }
    if (*config->exercise.local_solar && !config_local_solar(&unix_s, config)) {
        log_error(
            "config: %sexercise.local_solar: '%s' is not a time such as 2026-06-21T10:00:00, 1900 .. 2100, without a zone",
            config_where(config, "exercise.local_solar"), config->exercise.local_solar);
        good = false;
    }
    if (*config->exercise.local_solar && *config->exercise.utc) {
        log_error("config: %sexercise.local_solar: exercise.utc is set too; leave one of them out",
                  config_where(config, "exercise.local_solar"));
        good = false;
    }
    const char *const moment[2] = {config->exercise.from_s, config->exercise.to_s};
    bool              good_spans = true;
    for (int i = 0; i < 2; i++)
        if (!config_span_good(moment[i])) {
            good_spans = false;
            log_error(
                "config: %sexercise.%s: '%s' is not a number of seconds: 3471.5 is exercise time, +12 is from the "
                "recording's start, -5 from its end",
                config_where(config, i ? "exercise.to_s" : "exercise.from_s"), i ? "to_s" : "from_s", moment[i]);
            good = false;
        }
    if (good_spans && config_span_backward(config->exercise.from_s, config->exercise.to_s)) {
        log_error("config: %sexercise.from_s: %s is after exercise.to_s: %s", config_where(config, "exercise.from_s"),
                  config->exercise.from_s, config->exercise.to_s);
        good = false;
    }
    return good;
}

Status config_check(const Config *config)
{
    bool good = settings_paths_good(config, &config_table, "publish.video,record.path");
    good &= config_bands_check(config->sensor.bands, config_where(config, "sensor.bands"));
    good = detector_good(config) && good;
    good = terrain_good(config) && good;
    good = products_good(config) && good;
    good = scene_good(config) && good;
    good = exercise_good(config) && good;
    good &= !*config->record.path || dis_recorder_name("config: record.path", config->record.path);
    good &= publish_video_check(config) == STATUS_OK;
    const bool sensor = strcmp(config->sensor.preset, "none") != 0 || *config_sheet(config);
    good &= publish_memory_check(config, sensor) == STATUS_OK;
    good &= projector_check(config) == STATUS_OK;
    return good ? STATUS_OK : STATUS_BAD_VALUE;
}
