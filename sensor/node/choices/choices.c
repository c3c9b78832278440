/* sensor/node/choices/choices.c: exercise, time of day and shapes, where the configuration leaves them open. */
#include "sensor/node/choices/choices.h"

#include "dis/pdu/decode.h"
#include "sensor/node/player/player.h"
#include "terrain/earth/sun.h"

#include <stdio.h>
#include <time.h>

/* ---- exercise --------------------------------------------------------------------------------------- */

int choice_exercise(Choices *choices, const DisLog *log, const Config *config)
{
    int64_t     heard[256] = {0};
    DisCounters ignored = {0};
    int         most = 0, exercises = 0;
    if (config->exercise.exercise != -1) return config->exercise.exercise < 0 ? -1 : config->exercise.exercise;
    for (int i = 0; i < log->count; i++) {
        const DisDatagram datagram = dis_log_datagram(log, i);
        const uint8_t    *at = datagram.bytes, *pdu;
        DisHeader         header;
        while (dis_next_pdu(&header, &pdu, &at, datagram.bytes + datagram.octets, &ignored))
            heard[header.exercise] += player_usable(&header, pdu);
    }
    for (int e = 0; e < 256; e++) {
        exercises += heard[e] > 0;
        if (heard[e] > heard[most]) most = e;
    }
    if (exercises <= 1) return config->exercise.causal && exercises ? most : -1;
    choice_add(choices, "exercise: %d, heard most of %d (exercise.exercise)", most, exercises);
    return most;
}

/* ---- time of day ---------------------------------------------------------------------------- */

/* Reports senders whose time stamps are not a clock. */
static void report_anomalies(Choices *choices, const Survey *survey)
{
    enum { most_lines = 4 };
    char text[exercise_clock_anomaly_text_size];
    for (int i = 0; i < survey->doubts.count && i < most_lines; i++) {
        exercise_clock_anomaly_text(text, sizeof text, &survey->doubts.sender[i]);
        choice_add(choices, "%s", text);
    }
    if (survey->doubts.count > most_lines)
        choice_add(choices, "time stamps of %s%d more senders are no clock: `pitviper inspect` lists them",
                   survey->doubts.count == exercise_clock_anomalies_listed_max ? "at least " : "",
                   survey->doubts.count - most_lines);
    if (survey->doubts.unstamped > 0 && survey->doubts.stamped == 0)
        choice_add(choices, "clock: no PDU has a time stamp, all are 0: every PDU counts from its arrival");
    else if (survey->doubts.unstamped > 0)
        choice_add(choices,
                   "clock: %llu of %llu PDUs have no time stamp (0): they count from their arrival; `pitviper "
                   "inspect` says whose",
                   (unsigned long long)survey->doubts.unstamped,
                   (unsigned long long)(survey->doubts.unstamped + survey->doubts.stamped));
}

/* Unix time of a mean solar time that is given as Unix time at longitude 0: 2 pi of longitude are 86400 s. */
static double utc_of_solar_s(double clock_s, const LocalFrame *frame)
{
    return clock_s - frame->origin.lon_rad / (2 * pi_rad) * 86400;
}

enum { utc_text_size = 32 };

static void utc_text(char out[utc_text_size], double unix_s)
{
    const time_t seconds = (time_t)llround(unix_s);
    struct tm    at;
    if (!gmtime_r(&seconds, &at) || strftime(out, utc_text_size, "%Y-%m-%dT%H:%M:%SZ", &at) == 0)
        snprintf(out, utc_text_size, "no date");
}

Status choice_time(double *unix_s, Choices *choices, const Survey *survey, const Config *config,
                   const LocalFrame *frame)
{
    double first_unix_s;
    char   left_out[80] = "", utc[utc_text_size];
    report_anomalies(choices, survey);
    if (survey->absolute_left_out > 0)
        snprintf(left_out, sizeof left_out, "; %d of %d absolute stamps disagree and are left out",
                 survey->absolute_left_out, survey->absolute_stamps);
    if (*config->exercise.utc) {
        if (!text_to_unix_s(&first_unix_s, config->exercise.utc)) {
            log_error("replay: exercise.utc: '%s' is not a time such as 2026-06-21T10:00:00Z, 1900 .. 2100",
                      config->exercise.utc);
            return STATUS_BAD_VALUE;
        }
        *unix_s = first_unix_s - survey->first_s;
    } else if (*config->exercise.local_solar) {
        double clock_s;
        if (!config_local_solar(&clock_s, config)) {
            log_error(
                "replay: exercise.local_solar: '%s' is not a time such as 2026-06-21T10:00:00, 1900 .. 2100, without a zone",
                config->exercise.local_solar);
            return STATUS_BAD_VALUE;
        }
        *unix_s = utc_of_solar_s(clock_s, frame) - survey->first_s;
        utc_text(utc, *unix_s + survey->first_s);
        choice_add(choices, "time of day: local solar %s is %s (exercise.local_solar)", config->exercise.local_solar,
                   utc);
    } else if (isfinite(survey->clock_start_unix_s)) {
        *unix_s = survey->clock_start_unix_s;
        choice_add(choices, "time of day: the clock of a Start/Resume PDU (exercise.utc)");
    } else if (isfinite(survey->absolute_unix_s)) {
        *unix_s = survey->absolute_unix_s;
        choice_add(choices, "time of day: absolute time stamps and the date of the capture%s (exercise.utc)", left_out);
    } else {
        double ten_local_s = 0;
        text_to_unix_s(&ten_local_s, "2026-06-21T10:00:00Z");
        *unix_s = utc_of_solar_s(ten_local_s, frame) - survey->first_s;
        choice_add(choices, "time of day: local solar 10:00 on 21 June, %s (exercise.utc)",
                   survey->absolute_stamps > 1    ? "the absolute stamps of the log do not agree"
                   : survey->absolute_stamps == 1 ? "the log's one absolute stamp is too little to go by"
                                                  : "the log does not say");
    }
    return STATUS_OK;
}

void choice_report_night(Choices *choices, unsigned bands, double unix_s, const HostPlan *plan, const LocalFrame *frame)
{
    static const double dark_deg = -6;
    const double        at_s[2] = {plan->start_s, plan->end_s};
    double              lowest_deg = INFINITY;
    if (!(bands >> BAND_OPTICAL & 1)) return;
    for (int k = 0; k < 2; k++) {
        Sun sun;
        if (!isfinite(at_s[k]) || sun_at(&sun, unix_s + at_s[k], &frame->origin, 1013.25, 15, NAN) != STATUS_OK)
            continue;
        lowest_deg = fmin(lowest_deg, sun.elevation_rad / rad_per_deg);
    }
    if (lowest_deg < dark_deg)
        choice_add(
            choices,
            "optical: black or nearly so but for lamps (terrain.lamps), the sun is %.0f degrees below the horizon "
            "and the moon is not modelled; lwir and mwir see (exercise.utc, sensor.bands)",
            -lowest_deg);
}

/* ---- shapes ----------------------------------------------------------------------------------------- */

enum { most_named = 4 };

static bool same_type(DisEntityType a, DisEntityType b)
{
    return a.kind == b.kind && a.domain == b.domain && a.country == b.country && a.category == b.category &&
           a.subcategory == b.subcategory && a.specific == b.specific && a.extra == b.extra;
}

typedef struct Unshaped {
    int           entities, types, named;
    DisEntityType type[most_named];
} Unshaped;

static void count_unshaped(Unshaped *u, DisEntityType type)
{
    u->entities++;
    for (int i = 0; i < u->named; i++)
        if (same_type(u->type[i], type)) return;
    u->types++; /* a type beyond the stored ones may be counted again */
    if (u->named < most_named) u->type[u->named++] = type;
}

static void report_unshaped(Choices *choices, const Unshaped *u, const char *what, const char *how)
{
    char   text[160] = "";
    size_t n = 0;
    if (u->entities == 0) return;
    for (int i = 0; i < u->named && n < sizeof text; i++) {
        char type[dis_type_text_size];
        dis_entity_type_text(type, u->type[i]);
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%s", i ? ", " : "", type);
    }
    choice_add(choices, "shapes: %s of %d %s (%s%s); %s", what, u->entities, u->entities == 1 ? "entity" : "entities",
               text, u->types > u->named ? ", ..." : "", how);
}

void choice_shapes(Choices *choices, const Survey *survey, const Catalog *catalog)
{
    Unshaped unseen = {0}, unknown = {0}, chaff = {0};
    for (int i = 0; i < survey->track_count; i++) {
        const DisEntityType type = survey->track[i].type;
        int                 matched;
        const int           model = catalog_find(catalog, type, NULL, &matched);
        if (catalog_is_chaff(catalog, model)) count_unshaped(&chaff, type);
        else if (!catalog_has_shape(catalog, model)) count_unshaped(&unseen, type);
        else if (model == 0) count_unshaped(&unknown, type);
    }
    report_unshaped(choices, &unseen, "nothing is seen", "`none` in etc/catalog.csv");
    report_unshaped(choices, &chaff, "nothing is seen, but by radar.preset,", "`chaff` in etc/catalog.csv");
    report_unshaped(choices, &unknown, "a wedge is shown", "no row of etc/catalog.csv");
}
