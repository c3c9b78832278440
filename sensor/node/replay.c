#include "sensor/node/replay.h"

#include "sensor/node/frame_files.h"
#include "sensor/node/session.h"
#include "sensor/publish/records.h"

#include <errno.h>
#include <getopt.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { max_hosts = 64, path_size = 4096, config_text_size = 16384 };

typedef struct Options {
    const char *log, *out, *isa;
    int         threads, host_count;
    double      speed;
    bool        png, no_skip;
    const char *host[max_hosts];
    Config      config;
} Options;

static const char help[] =
    "usage: pitviper replay LOG [options]\n"
    "\n"
    "Shows what the seeker of the missile in a recorded DIS exercise (pcap, pcapng) saw: pictures per band,\n"
    "truth per pixel and per target. Needs no configuration; what was chosen is printed, with its key.\n"
    "\n"
    "  --out DIR          where the products go (default: out)\n"
    "  --bands LIST       any of optical,mwir,lwir,radar (default: all)\n"
    "  --size WxH         picture size in pixels (default: 720x486)\n"
    "  --rate HZ          frames a second of exercise time (default: 5 for a munition, 1 for an observer)\n"
    "  --from S, --to S   only this span of exercise time, in seconds as `pitviper inspect` shows them; frames keep\n"
    "                     the numbers they have in the whole\n"
    "  --host ID          site:application:entity that carries the sensor; may be given several times\n"
    "  --samples N        N x N rays a pixel (default: 1)\n"
    "  --config FILE      a YAML file of settings; options here override it\n"
    "  --set KEY=VALUE    one setting, as the printed choices name them; may be given several times\n"
    "  --threads N        default: one for each processor\n"
    "  --seed N           of everything random (default: 1)\n"
    "  --speed X          exercise seconds a second, or max (default: max)\n"
    "  --causal           use only what had been received by each frame, as a live node would\n"
    "  --no-skip          compute what is known to change nothing; the pictures stay the same to the bit\n"
    "  --isa NAME         instruction set of the tracer: avx2 (default), sse4.2, avx512\n"
    "  --no-png           no display pictures, only EXR\n";

/* ---- command line --------------------------------------------------------------------------- */

static bool set_size(Config *config, const char *text)
{
    char        width[16];
    const char *x = strchr(text, 'x');
    if (!x || x == text || x - text >= (long)sizeof width) {
        log_error("replay: --size: '%s' is not WIDTHxHEIGHT, for example 720x486", text);
        return false;
    }
    memcpy(width, text, (size_t)(x - text));
    width[x - text] = 0;
    return config_set(config, "sensor.width_px", width, "--size") == STATUS_OK &&
           config_set(config, "sensor.height_px", x + 1, "--size") == STATUS_OK;
}

static bool set_pair(Config *config, const char *text)
{
    char        key[64];
    const char *equals = strchr(text, '=');
    if (!equals || equals - text >= (long)sizeof key) {
        log_error("replay: --set: '%s' is not KEY=VALUE, for example sensor.hfov_deg=3", text);
        return false;
    }
    memcpy(key, text, (size_t)(equals - text));
    key[equals - text] = 0;
    return config_set(config, key, equals + 1, "--set") == STATUS_OK;
}

enum { OUT = 1, BANDS, SIZE, RATE, FROM, TO, HOST, SAMPLES, CONFIG, SET, THREADS, SEED, SPEED, CAUSAL, NO_SKIP, ISA,
       NO_PNG, HELP };

static const struct option options[] = {
    {"out", 1, NULL, OUT}, {"bands", 1, NULL, BANDS}, {"size", 1, NULL, SIZE}, {"rate", 1, NULL, RATE},
    {"from", 1, NULL, FROM}, {"to", 1, NULL, TO}, {"host", 1, NULL, HOST}, {"samples", 1, NULL, SAMPLES},
    {"config", 1, NULL, CONFIG}, {"set", 1, NULL, SET}, {"threads", 1, NULL, THREADS}, {"seed", 1, NULL, SEED},
    {"speed", 1, NULL, SPEED}, {"causal", 0, NULL, CAUSAL}, {"no-skip", 0, NULL, NO_SKIP}, {"isa", 1, NULL, ISA},
    {"no-png", 0, NULL, NO_PNG}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};

/* The configuration file first, whatever its place on the line: options override it. */
static Status read_config(Config *config, int argc, char **argv)
{
    Status status = STATUS_OK;
    char **copy = calloc((size_t)argc + 1, sizeof *copy); /* getopt_long moves what it is given about */
    if (!copy) return STATUS_NO_MEMORY;
    memcpy(copy, argv, (size_t)argc * sizeof *copy);
    optind = 0; /* start anew */
    opterr = 0; /* the pass over all options speaks */
    for (int option; status == STATUS_OK && (option = getopt_long(argc, copy, "", options, NULL)) != -1;)
        if (option == CONFIG) status = config_read(config, optarg);
    opterr = 1;
    free(copy);
    return status;
}

/* 0: go on; else exit with this code - 1. */
static int parse(Options *o, int argc, char **argv)
{
    static const struct { int option; const char *key; } direct[] = {
        {BANDS, "sensor.bands"}, {RATE, "sensor.rate_hz"}, {FROM, "exercise.from_s"}, {TO, "exercise.to_s"},
        {SAMPLES, "sensor.samples"}, {SEED, "seed"}};
    long long number;

    const Status status = read_config(&o->config, argc, argv);
    if (status == STATUS_NO_MEMORY) log_error("replay: out of memory");
    if (status != STATUS_OK) return 1 + (status == STATUS_NO_MEMORY ? 1 : 2);
    optind = 0;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        bool ok = true;
        for (size_t i = 0; i < sizeof direct / sizeof direct[0]; i++)
            if (direct[i].option == option) {
                char source[16];
                snprintf(source, sizeof source, "--%s", options[option - 1].name);
                ok = config_set(&o->config, direct[i].key, optarg, source) == STATUS_OK;
            }
        switch (option) {
        case OUT: o->out = optarg; break;
        case SIZE: ok = set_size(&o->config, optarg); break;
        case SET: ok = set_pair(&o->config, optarg); break;
        case HOST:
            ok = o->host_count < max_hosts;
            if (!ok) log_error("replay: more than %d hosts", max_hosts);
            else o->host[o->host_count++] = optarg;
            break;
        case THREADS:
            ok = text_to_long(&number, optarg) && number >= 1 && number <= 256;
            if (!ok) log_error("replay: --threads: '%s' is not a whole number in 1 .. 256", optarg);
            else o->threads = (int)number;
            break;
        case SPEED:
            if (strcmp(optarg, "max") == 0) {
                o->speed = INFINITY;
            } else {
                ok = text_to_double(&o->speed, optarg) && o->speed >= 1e-3 && o->speed <= 1e6;
                if (!ok) log_error("replay: --speed: '%s' is neither `max` nor a number in 0.001 .. 1000000", optarg);
            }
            break;
        case CAUSAL: o->config.causal = true; break;
        case NO_SKIP: o->no_skip = true; break;
        case ISA:
            ok = strcmp(optarg, "avx2") == 0 || strcmp(optarg, "sse4.2") == 0 || strcmp(optarg, "avx512") == 0;
            if (!ok) log_error("replay: --isa: '%s' is not avx2, sse4.2 or avx512", optarg);
            o->isa = optarg;
            break;
        case NO_PNG: o->png = false; break;
        case HELP: fputs(help, stdout); return 1 + 0;
        case '?': ok = false; break; /* getopt has said which */
        default: break;
        }
        if (!ok) {
            fputs("see `pitviper replay --help`\n", stderr);
            return 1 + 2;
        }
    }
    if (optind + 1 != argc) {
        fputs("usage: pitviper replay LOG [options]; see `pitviper replay --help`\n", stderr);
        return 1 + 2;
    }
    o->log = argv[optind];
    if (o->host_count == 1 && config_set(&o->config, "exercise.host", o->host[0], "--host") != STATUS_OK) return 1 + 2;
    if (o->host_count == 1) o->host_count = 0; /* one host is a setting like any other */
    return config_check(&o->config) == STATUS_OK ? 0 : 1 + 2;
}

static bool parse_bands(unsigned *bands, const char *text)
{
    *bands = 0;
    for (const char *at = text; *at;) {
        const size_t length = strcspn(at, ",");
        int          found  = -1;
        for (int b = 0; b < BAND_COUNT; b++)
            if (strlen(band_name((Band)b)) == length && strncmp(band_name((Band)b), at, length) == 0) found = b;
        if (found < 0) {
            log_error("replay: sensor.bands: '%s' is not a list of optical, mwir, lwir, radar", text);
            return false;
        }
        *bands |= 1u << found;
        at += length + (at[length] == ',');
    }
    if (*bands == 0) log_error("replay: sensor.bands: no band is named; any of optical, mwir, lwir, radar");
    return *bands != 0;
}

/* ---- the run -------------------------------------------------------------------------------- */

/* What threads, speed and paths cannot change: every setting that the pictures depend on. */
static Status hash_config(char out[sha256_text_size], const Options *o)
{
    char   text[config_text_size];
    size_t n;
    config_text(text, sizeof text, &o->config);
    n = strlen(text);
    for (int i = 0; i < o->host_count; i++) n += (size_t)snprintf(text + n, sizeof text - n, "host=%.32s\n", o->host[i]);
    return sha256_bytes(out, text, n);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void summarise_stages(double out[session_stages][3], const SessionResult *r)
{
    double *sorted = calloc((size_t)r->frames + 1, sizeof *sorted);
    for (int stage = 0; sorted && stage < session_stages; stage++) {
        for (int i = 0; i < r->frames; i++) sorted[i] = r->stage_ms[i][stage];
        qsort(sorted, (size_t)r->frames, sizeof *sorted, compare_doubles);
        out[stage][0] = sorted[r->frames / 2];
        out[stage][1] = sorted[(int)(0.95 * (r->frames - 1))];
        out[stage][2] = sorted[r->frames - 1];
    }
    free(sorted);
}

typedef struct Run {
    Options       options;
    DisLog        log;
    Survey        survey;
    Catalog      *catalog;
    World         world;
    Pool         *pool;
    char          config_sha256[sha256_text_size], log_sha256[sha256_text_size];
    unsigned      bands;
    int           exercise; /* -1: all */
    Choices       choices; /* those that all hosts share */
    Sensors       sensors;
} Run;

static Status write_run(const Run *run, const char *out, const HostPlan *plan, const Choices *choices,
                        const SessionResult *result)
{
    char        path[path_size + 16], log_path[path_size], host[dis_id_text_size] = "observer";
    const char *hosts[1] = {host}, *choice[choices_capacity];
    double      stage_ms[session_stages][3] = {{0}};
    const char **hash = calloc((size_t)result->frames + 1, sizeof *hash);
    if (!hash) return STATUS_NO_MEMORY;

    for (int i = 0; i < result->frames; i++) hash[i] = result->hash[i];
    for (int i = 0; i < choices->count; i++) choice[i] = choices->line[i];
    if (!dis_entity_id_is_none(plan->host)) dis_entity_id_text(host, plan->host);
    summarise_stages(stage_ms, result);
    snprintf(log_path, sizeof log_path, "%s", run->options.log);
    snprintf(path, sizeof path, "%s/run.json", out);
    const DisLogCounters *link = &run->log.counters;
    const RunRecord       record = {
              .config_sha256 = run->config_sha256, .log_name = basename(log_path), .log_sha256 = run->log_sha256,
              .isa = run->options.isa, .seed = run->options.config.seed, .threads = run->options.threads,
              .host_count = 1, .choice_count = choices->count, .frames = result->frames, .host = hosts,
              .choice = choice, .frame_sha256 = hash, .dis = &run->survey.counters,
              .link_dropped = link->other_protocol + link->other_port + link->cut_short + link->bad_fragment,
              .entities_created = result->entities.created, .entities_timed_out = result->entities.timed_out,
              .entities_deactivated = result->entities.deactivated, .entities_removed = result->entities.removed,
              .effects = result->effects, .render = result->counters, .stage_count = session_stages, .stage = session_stage_name,
              .stage_ms = stage_ms};
    const Status status = record_write_run(path, &record);
    free(hash);
    return status;
}

/* One host: its own ground and frame, its own folder when there are several. */
/* host_text: checked already; NULL: as configured, or chosen. */
static void say_visibility(Choices *choices, const Config *config, const Atmosphere *atmosphere)
{
    double low_m, high_m;
    atmosphere_visibilities(atmosphere, &low_m, &high_m);
    if (config->weather.visibility_m < low_m || config->weather.visibility_m > high_m)
        choice_add(choices, "air: the tables reach visibilities of %.0f to %.0f m; the nearest of them is taken "
                   "(weather.visibility_m)", low_m, high_m);
}

static Status run_host(Run *run, const char *host_text)
{
    const Options *o       = &run->options;
    Choices        choices = run->choices;
    HostPlan       plan;
    LocalFrame     frame;
    Landscape      landscape = {0};
    World         *world     = &run->world;
    SessionResult  result    = {0};
    double         unix_s    = 0;
    bool           clamp     = false;
    char           out[path_size];
    DisEntityId    host;
    Status         status;

    if (host_text) printf("host: %s (--host)\n", host_text);
    if (host_text && dis_entity_id_parse(&host, host_text))
        status = plan_host(&plan, &choices, &run->survey, &o->config, host);
    else
        status = choose_host(&plan, &choices, &run->survey, &o->config);
    if (status != STATUS_OK) return status;
    status = choose_frame(&frame, &run->survey, &plan);
    if (status == STATUS_OK) status = choose_time(&unix_s, &choices, &run->survey, &o->config, &frame);
    if (status == STATUS_OK)
        status = choose_ground(&landscape, &clamp, &choices, &run->survey, &o->config, &frame, run->catalog, &plan);
    if (status == STATUS_OK) status = world_open(world, run->catalog, &landscape, &frame, o->isa);
    if (status != STATUS_OK) goto done;
    status = atmosphere_open(&world->atmosphere, o->config.weather.atmosphere);
    if (status != STATUS_OK) goto done;
    say_visibility(&choices, &o->config, world->atmosphere);
    world->radar.lobe_rad = o->config.radar.lobe_deg * rad_per_deg;
    choose_rate(&plan, &choices, &o->config);
    for (int i = 0; i < choices.count; i++) printf("%s\n", choices.line[i]);
    fflush(stdout);

    if (o->host_count > 1)
        snprintf(out, sizeof out, "%s/%u-%u-%u", o->out, plan.host.site, plan.host.application, plan.host.entity);
    else
        snprintf(out, sizeof out, "%s", o->out);
    const SessionShared shared = {.config = &o->config, .log = &run->log, .survey = &run->survey,
                                  .catalog = run->catalog, .world = world, .pool = run->pool, .unix_s = unix_s,
                                  .bands = run->bands, .exercise = run->exercise, .png = o->png,
                                  .no_skip = o->no_skip, .speed = o->speed, .sensors = &run->sensors,
                                   .clamp = clamp, .config_sha256 = run->config_sha256};
    status = session_run(&result, &shared, &plan, out);
    if (result.frames > 0) { /* what could be shown is recorded, even when it stopped early */
        const Status written = write_run(run, out, &plan, &choices, &result);
        if (status == STATUS_OK) status = written;
        printf("%d frames in %s/frames\n", result.frames, out);
        if (result.buried > 0)
            log_warn("replay: the eye was below the ground in %d of %d frames and saw nothing of use%s", result.buried,
                     result.frames, *o->config.terrain.elevation && strcmp(o->config.terrain.ground, "fit") != 0
                         ? "; over other ground than the exercise's, terrain.ground=fit leads it through" : "");
    }

done:
    session_result_free(&result);
    world_close(world);
    landscape_destroy(&landscape);
    return status;
}

static void say_drops(const Survey *survey)
{
    for (int i = 0; i < DIS_DROP_COUNT; i++)
        if (survey->counters.dropped[i])
            log_warn("replay: dropped: %s=%llu", dis_drop_name((DisDrop)i), (unsigned long long)survey->counters.dropped[i]);
}

/* All hosts before the first frame of any: a slip in the last is not found out after an hour. */
static Status check_hosts(const Run *run)
{
    for (int i = 0; i < run->options.host_count; i++) {
        DisEntityId host;
        if (!dis_entity_id_parse(&host, run->options.host[i])) {
            log_error("replay: --host: '%s' is not site:application:entity, for example 1:3001:82", run->options.host[i]);
            return STATUS_BAD_VALUE;
        }
        for (int k = 0; k < i; k++) {
            DisEntityId other;
            if (dis_entity_id_parse(&other, run->options.host[k]) && dis_entity_id_compare(host, other) == 0) {
                log_error("replay: --host: %s is given twice", run->options.host[i]);
                return STATUS_BAD_VALUE;
            }
        }
        if (!survey_track(&run->survey, host)) {
            log_error("replay: --host: %s is not in the log; `pitviper inspect LOG` lists who is", run->options.host[i]);
            return STATUS_BAD_VALUE;
        }
    }
    return STATUS_OK;
}

static Status open_run(Run *run)
{
    Options *o = &run->options;
    char     path[path_size];
    if (!parse_bands(&run->bands, o->config.sensor.bands)) return STATUS_BAD_VALUE;
    Status status = sensors_choose(&run->sensors, &run->choices, &o->config, run->bands);
    if (status == STATUS_OK) status = dis_log_open(&run->log, o->log, o->config.exercise.port);
    if (status == STATUS_OK) status = sha256_file(run->log_sha256, o->log);
    if (status == STATUS_OK) status = hash_config(run->config_sha256, o);
    if (status != STATUS_OK) return status;
    if (run->log.retimed)
        choice_add(&run->choices, "clock: the time stamps; the capture's packet times do not keep pace with them");
    if (run->log.any_port && o->config.exercise.port == dis_port_default)
        choice_add(&run->choices, "port: any that carries DIS, nothing went to 3000 (exercise.port)");
    run->exercise = choose_exercise(&run->choices, &run->log, &o->config);
    status        = survey_log(&run->survey, &run->log, run->exercise);
    if (status != STATUS_OK) return status;
    say_drops(&run->survey);
    if (run->survey.track_count == 0) {
        log_error("replay: %s holds no Entity State with a usable position (%llu datagrams heard); "
                  "`pitviper inspect %s` says what it holds, --set exercise.port=N takes another port",
                  o->log, (unsigned long long)run->survey.counters.datagrams, o->log);
        return STATUS_BAD_VALUE;
    }
    status = check_hosts(run);
    if (status != STATUS_OK) return status;
    if (!etc_path(path, sizeof path, "catalog.csv")) return STATUS_BAD_VALUE;
    status = catalog_open(&run->catalog, path, o->config.models.sag_m);
    if (status == STATUS_OK) status = pool_create(&run->pool, o->threads);
    return status;
}

int replay_command(int argc, char **argv)
{
    Run run = {.options = {.out = "out", .isa = "avx2", .threads = thread_processors(), .speed = INFINITY, .png = true,
                           .config = config_default()}};
    const int stop = parse(&run.options, argc, argv);
    if (stop) return stop - 1;

    thread_flush_denormals();
    Status failed = STATUS_OK, status = open_run(&run);
    if (status == STATUS_OK && run.options.host_count == 0) status = run_host(&run, NULL);
    if (status == STATUS_OK && run.options.host_count > 1) frame_files_clear(run.options.out);
    for (int i = 0; status == STATUS_OK && i < run.options.host_count; i++) {
        const Status one = run_host(&run, run.options.host[i]);
        if (one != STATUS_OK) failed = one; /* the others are still shown */
    }
    if (status == STATUS_OK) status = failed;
    if (status == STATUS_NO_MEMORY)
        log_error("replay: out of memory; smaller pictures (--size), fewer bands (--bands) or more memory");

    pool_destroy(run.pool);
    catalog_close(run.catalog);
    survey_destroy(&run.survey);
    dis_log_close(&run.log);
    return status == STATUS_OK ? 0 : 1;
}
