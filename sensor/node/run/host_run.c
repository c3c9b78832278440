/* sensor/node/run/host_run.c: from received datagrams to choices, a world, a session and run.json. */
#include "sensor/node/run/host_run_private.h"

#include "dis/capture/log.h"
#include "sensor/node/choices/choices.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/publish/memory/consume_memory.h"
#include "sensor/publish/video/consume_video.h"
#include "sensor/quality/quality.h"
#include "sensor/quality/quality_measure.h"
#include "sensor/settings/publish_choice.h"
#include "sensor/frame/frame_world.h"

#include <stdio.h>
#include <stdlib.h>

enum { path_size = 4096 };

/* ---- before ---------------------------------------------------------------------------------- */

/* Hashes every setting that the images depend on: threads, speed and paths do not change it. */
static Status hash_config(char out[sha256_text_size], const Options *o)
{
    char   text[config_text_size];
    size_t n;
    config_text(text, sizeof text, &o->config);
    n = strlen(text);
    for (int i = 0; i < o->host_count; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "host=%.32s\n", o->host[i]);
    return sha256_bytes(out, text, n);
}

Status run_measure_machine(Run *run)
{
    Config *config = &run->options.config;
    char    path[1024], text[32];
    double  factor;
    if (!quality_wants_factor(config)) return STATUS_OK;
    if (*config->quality.table) snprintf(path, sizeof path, "%s", config->quality.table);
    else if (!etc_path(path, sizeof path, "quality.csv")) return STATUS_BAD_VALUE;
    Status status = quality_machine_factor(&factor, path, run->options.threads);
    if (status != STATUS_OK) return status;
    snprintf(text, sizeof text, "%g", factor);
    choice_add(&run->choices, "machine: %s times the time in the table of settings, measured (quality.machine_factor)",
               text);
    return config_set(config, "quality.machine_factor", text, "run");
}

Status run_prepare(Run *run)
{
    if (!run->options.config.publish.truth && !clock_on_wall(run->clock) && !*run->options.config.exercise.cigi) {
        log_error(
            "%s: publish.truth: false is for `run`, `replay --speed X` and `--cigi`; a replay at full speed always has truth",
            options_command(&run->options));
        return STATUS_BAD_VALUE;
    }
    if (!run->options.config.publish.truth)
        choice_add(&run->choices, "truth: no truth.jsonl and no hashes of frames (publish.truth)");
    if (!config_bands_choose(&run->bands, run->options.config.sensor.bands)) return STATUS_BAD_VALUE;
    PlaneSet planes;
    publish_planes_parse(&planes, run->options.config.publish.planes);
    if (planes != planes_named("", 0) && planes & planes_named("emissivity", 10) &&
        !(run->bands & (1u << BAND_MWIR | 1u << BAND_LWIR))) {
        log_error(
            "%s: publish.planes: emissivity is of thermal bands, and none is rendered; add mwir or lwir to sensor.bands",
            options_command(&run->options));
        return STATUS_BAD_VALUE;
    }
    const Status flies = run_check_flight(run);
    if (flies != STATUS_OK) return flies;
    Status status = config_own_tables(&run->options.config);
    if (status != STATUS_OK) return status;
    status = quality_choose(&run->options.config, &run->choices, run->bands);
    if (status != STATUS_OK) return status;
    status = sensors_choose(&run->sensors, &run->choices, &run->options.config, run->bands);
    return status == STATUS_OK ? hash_config(run->config_sha256, &run->options) : status;
}

/* Loads the libraries that products need, on this thread, before the pool starts. */
static Status load_libraries(const Config *config)
{
    const bool images = config->publish.files || config->publish.latest;
    Status     status = images ? image_file_prepare() : STATUS_OK;
    return status == STATUS_OK ? video_prepare(config) : status;
}

Status run_made(Run *run)
{
    if (run->made) return STATUS_OK;
    run->owns = true;
    return made_world_create(&run->made);
}

Status run_survey(Run *run, const DisLog *heard, const DisLog *from)
{
    const Options *o = &run->options;
    char           path[path_size];
    Status         status = run_made(run);
    if (status != STATUS_OK) return status;
    run->exercise = choice_exercise(&run->choices, heard, &o->config);
    log_detail("%s: %d threads, %s, config_sha256 %s", options_command(o), o->threads, o->isa, run->config_sha256);
    status = made_survey(run->made, heard, run->exercise);
    if (status == STATUS_OK) status = made_basis(run->made, from, heard, run->exercise);
    if (status != STATUS_OK) return status;
    const DisCounters *counters = &run->made->survey.counters;
    for (int i = 0; i < DIS_DROP_COUNT; i++)
        if (counters->dropped[i])
            log_warn("%s: dropped: %s=%llu: %s", options_command(o), dis_drop_name((DisDrop)i),
                     (unsigned long long)counters->dropped[i], dis_drop_cause((DisDrop)i));
    if (counters->lengths_made)
        log_warn("%s: %llu PDUs have a length field of 0, which their sender should set: taken by their type and the "
                 "datagram's length",
                 options_command(o), (unsigned long long)counters->lengths_made);
    if (!etc_path(path, sizeof path, "catalog.csv")) return STATUS_BAD_VALUE;
    status = tables_used(&run->tables, &o->config, path);
    if (status == STATUS_OK) status = made_catalog(run->made, &o->config, &run->tables);
    if (status == STATUS_OK) status = tables_given(&run->tables, &o->config);
    if (status == STATUS_OK) status = load_libraries(&o->config);
    made_cache(run->made, &o->config);
    return status == STATUS_OK ? made_pool(run->made, o->threads) : status;
}

void run_close(Run *run)
{
    if (run->owns) made_world_destroy(run->made);
    run->made = NULL;
}

/* ---- its folder ------------------------------------------------------------------------------ */

void run_folder(char out[run_folder_size], const Options *o, DisEntityId host)
{
    if (o->host_count > 1 && dis_entity_id_is_none(host))
        snprintf(out, run_folder_size, "%s/%s", o->out, host_observer);
    else if (o->host_count > 1)
        snprintf(out, run_folder_size, "%s/%u-%u-%u", o->out, host.site, host.application, host.entity);
    else snprintf(out, run_folder_size, "%s", o->out);
}

/* ---- one host -------------------------------------------------------------------------------- */

static void report_visibility(Choices *choices, const Config *config, const Atmosphere *atmosphere)
{
    double low_m, high_m;
    atmosphere_visibilities(atmosphere, &low_m, &high_m);
    if (config->weather.visibility_m < low_m && frame_world_fog(config) != WEATHER_FOG_NONE) return;
    if (config->weather.visibility_m < low_m || config->weather.visibility_m > high_m)
        choice_add(choices,
                   "air: the tables reach visibilities of %.0f to %.0f m; the nearest of them is taken "
                   "(weather.visibility_m)",
                   low_m, high_m);
    else if (config->weather.visibility_m < 1000 && frame_world_fog(config) == WEATHER_FOG_NONE)
        choice_add(choices,
                   "air: %.0f m of visibility is haze as thick as that; a fog of droplets is denser in "
                   "infrared (weather.fog)",
                   config->weather.visibility_m);
}

/* The model of the atmosphere begins at the ground, whatever its height: high ground has the temperature of low
 * ground. */
static void report_air_temp(Choices *choices, const Config *config, const Atmosphere *atmosphere, double ground_m)
{
    const double here_k = atmosphere_temp_k(atmosphere, 0), high_k = atmosphere_temp_k(atmosphere, ground_m);
    if (isnan(config->weather.air_temp_k) && ground_m > 500)
        choice_add(choices,
                   "air: %.0f C at the ground, as the model has it at its own; it has %.0f C at the %.0f m "
                   "where this ground lies (weather.air_temp_k)",
                   here_k - 273.15, high_k - 273.15, ground_m);
}

/* Of a model whose air follows the weather, the channels whose air does not: names, separated by commas. */
static void list_fixed(char *out, size_t out_size, const Atmosphere *atmosphere)
{
    *out = 0;
    for (int p = 0; p < SPECTRAL_PLACES; p++) {
        const size_t length = strlen(out);
        if (atmosphere_band_follows(atmosphere, (AirBand)p)) continue;
        snprintf(out + length, out_size - length, "%s%s", length ? ", " : "", channel_in((ChannelPlace)p)->name);
    }
}

/* A model or a channel of one's own has the air of its tables, whatever the weather: said where that is far from what
 * is set, or from a weather file's at exercise time 0. */
static void report_fixed_air(Choices *choices, const Config *config, const World *world, double unix_s)
{
    const Atmosphere *atmosphere = world->atmosphere;
    Weather           weather = weather_default();
    char              fixed[SPECTRAL_PLACES * (channel_name_size + 2)];
    char              model[frame_model_size];
    list_fixed(fixed, sizeof fixed, atmosphere);
    if (!*fixed || frame_world_model(model, config) != STATUS_OK) return;
    if (strcmp(model, config->weather.atmosphere) != 0)
        choice_add(choices, "air: %s is that of %s nearest to the weather (weather.atmosphere)", model,
                   config->weather.atmosphere);
    const double own_k = atmosphere_temp_k(atmosphere, 0), own_kg_m3 = atmosphere_vapour_kg_m3(atmosphere);
    weather.air_temp_k = isnan(config->weather.air_temp_k) ? own_k : config->weather.air_temp_k;
    weather.humidity = 0.01 * config->weather.humidity_pct;
    if (strpbrk(config->weather.day, "/.")) weather = frame_weather_at(config, world, unix_s); /* not a day's course */
    const double set_kg_m3 = weather_vapour_kg_m3(&weather);
    if (atmosphere_follows_weather(atmosphere)) {
        if (fabs(weather.air_temp_k - own_k) > 5 || fabs(set_kg_m3 - own_kg_m3) > 0.2 * own_kg_m3)
            choice_add(choices,
                       "air: %s keeps the clear air of %s (%.0f C and %.1f g/m3 of water vapour at the ground), the "
                       "weather has %.0f C and %.1f (etc/atmosphere/vapour.bin lacks this channel)",
                       fixed, model, own_k - 273.15, 1e3 * own_kg_m3, weather.air_temp_k - 273.15, 1e3 * set_kg_m3);
        return;
    }
    if (fabs(weather.air_temp_k - own_k) > 5)
        choice_add(choices,
                   "air: %s is of %.0f C at the ground, the weather of %.0f C; transmittance stays that of its tables "
                   "(weather.air_temp_k; weather.atmosphere: us1976 follows the weather)",
                   model, own_k - 273.15, weather.air_temp_k - 273.15);
    if (fabs(set_kg_m3 - own_kg_m3) > 0.2 * own_kg_m3)
        choice_add(choices,
                   "air: %s has %.1f g/m3 of water vapour at the ground, the weather %.1f; transmittance stays that of "
                   "its tables (weather.humidity_pct; weather.atmosphere: us1976 follows the weather)",
                   model, 1e3 * own_kg_m3, 1e3 * set_kg_m3);
}

static Status choose_who(HostPlan *plan, Choices *choices, const Survey *survey, const Config *config,
                         const DisEntityId *host)
{
    return host ? choice_named_host(plan, choices, survey, config, *host) : choice_host(plan, choices, survey, config);
}

/* Causal: nothing is rendered of the time before the choices; the end is open. */
static void open_span(HostPlan *plan, const Run *run, const Player *player)
{
    if (!run->options.config.exercise.causal) return;
    plan->start_s = player_time_s(player, run->until_s);
    plan->end_s = INFINITY;
}

static FrameGrid grid_of(const HostPlan *plan)
{
    return (FrameGrid){ceil(plan->start_s * plan->rate_hz - 1e-9), plan->rate_hz};
}

Status run_check(Run *run, const DisEntityId *host)
{
    HostPlan plan = {0};
    Player  *player = NULL;
    Choices *choices = malloc(sizeof *choices); /* made again by run_host, in its order */
    if (!choices) return STATUS_NO_MEMORY;
    *choices = run->choices;
    Status status = choose_who(&plan, choices, &run->made->survey, &run->options.config, host);
    if (status == STATUS_OK) status = player_create(&player, run->exercise, run->options.config.exercise.causal);
    if (status == STATUS_OK && run->options.config.exercise.causal) status = player_add_log(player, &run->view);
    if (status == STATUS_OK) {
        open_span(&plan, run, player);
        choice_rate(&plan, choices, &run->options.config);
        const FrameGrid grid = grid_of(&plan);
        status = run->check ? run->check(run, player, &plan, &grid) : STATUS_OK;
    }
    player_destroy(player);
    free(choices);
    return status;
}

/* What is chosen for one host. */
typedef struct HostChoice {
    HostPlan plan;
    double   unix_s;  /* of exercise time 0 */
    Choices  choices; /* the lines of all hosts, and of this one */
} HostChoice;

/* The plan whose world it is: of a causal replay, that of a replay which knows the whole recording, whose ground is its
 * own too; nothing is said of it. */
static Status plan_of_world(HostPlan *out, const Run *run, const HostPlan *plan, const DisEntityId *host)
{
    const Survey *basis = made_basis_survey(run->made);
    *out = *plan;
    if (run->live || run->noted || !run->options.config.exercise.causal ||
        !choice_host_is_known(basis, &run->options.config, host))
        return STATUS_OK;
    Config  *whole = malloc(sizeof *whole);
    Choices *unsaid = calloc(1, sizeof *unsaid);
    Status   status = whole && unsaid ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        *whole = run->options.config;
        whole->exercise.causal = false;
        status = choose_who(out, unsaid, basis, whole, host);
    }
    free(whole), free(unsaid);
    return status;
}

/* Where the world lies, and the square in which its plants stand: as noted, or by its plan. */
static Status place_world(LocalFrame *frame, WoodsSquare *square, Choices *choices, const Run *run,
                          const HostPlan *plan, const DisEntityId *host)
{
    const Config      *config = &run->options.config;
    const Survey      *basis = made_basis_survey(run->made);
    const WoodsSquare *was = &run->world_note.square;
    HostPlan           of;
    Status             status = plan_of_world(&of, run, plan, host);
    if (status == STATUS_OK)
        status =
            run->noted ? local_frame_at(frame, &run->world_note.origin) : choice_world_frame(frame, basis, config, &of);
    if (status == STATUS_OK && *config->terrain.store) {
        double p_ecef[3];
        if (!choice_aim_place(p_ecef, basis, &of)) memcpy(p_ecef, frame->origin_ecef, sizeof p_ecef);
        status = choice_store_frame(frame, choices, config, p_ecef);
    }
    if (status == STATUS_OK) status = choice_square(square, basis, config, frame, &of);
    const bool same = run->noted && was->own == square->own;
    if (status == STATUS_OK && same && (!was->own || was->half_width_m == square->half_width_m)) *square = *was;
    return status;
}

/* Notes in the recording of a live node what its world was made from. */
static void note_world(const Run *run, const LocalFrame *frame, const WoodsSquare *square)
{
    char text[world_note_size];
    if (!run->note) return;
    world_note_text(text, &(WorldNote){run->until_s, frame->origin, *square});
    run->note(run->user, text);
}

/* Makes the choices and the world, and prints their messages. */
static Status choose(HostChoice *out, Run *run, const DisEntityId *host)
{
    const Options *o = &run->options;
    MadeWorld     *made = run->made;
    HostPlan      *plan = &out->plan;
    Choices       *choices = &out->choices;
    LocalFrame     frame;
    WoodsSquare    square;
    Status         status = choose_who(plan, choices, &made->survey, &o->config, host);
    if (status == STATUS_OK) status = place_world(&frame, &square, choices, run, plan, host);
    if (status == STATUS_OK) status = choice_time(&out->unix_s, choices, &made->survey, &o->config, &frame);
    if (status == STATUS_OK)
        status =
            made_world(made, choices, &(MadeOf){&o->config, &run->tables, plan, &frame, &square, out->unix_s, o->isa});
    if (status != STATUS_OK) return status;
    note_world(run, &frame, &square);
    report_visibility(choices, &o->config, made->world.atmosphere);
    report_fixed_air(choices, &o->config, &made->world, out->unix_s);
    report_air_temp(choices, &o->config, made->world.atmosphere,
                    elevation_height(&made->landscape.elevation, 0, 0, NULL));
    choice_rate(plan, choices, &o->config);
    choice_report_night(choices, run->bands, out->unix_s, plan, &frame);
    for (int i = 0; i < choices->count; i++) log_print("%s\n", choices->line[i]);
    fflush(stdout);
    return STATUS_OK;
}

Status run_host(Run *run, const DisEntityId *host)
{
    const Options *o = &run->options;
    MadeWorld     *made = run->made;
    HostChoice     chosen = {.choices = run->choices};
    SessionResult  result = {0};
    Player        *player = NULL;
    Session       *session = NULL;
    NodeFlight    *flight = NULL;
    char           out[run_folder_size], host_text[dis_id_text_size];

    if (host) {
        choice_host_name(host_text, &(HostPlan){.host = *host});
        log_print("host: %s (--host)\n", host_text);
    }
    Status status = choose(&chosen, run, host);
    if (status == STATUS_OK) status = player_create(&player, run->exercise, o->config.exercise.causal);
    if (status == STATUS_OK) status = player_add_log(player, &run->view);
    if (status != STATUS_OK) goto done;
    open_span(&chosen.plan, run, player);
    run_folder(out, o, chosen.plan.host);
    const DisOf dis = {.config = &o->config,
                       .bands = run->bands,
                       .version = run->first.version,
                       .exercise = (uint8_t)(run->exercise >= 0 ? run->exercise : run->first.exercise),
                       .send = run->send,
                       .user = run->user};
    status = run_open_flight(&flight, run, player, out, &chosen.plan);
    if (status != STATUS_OK) goto done;
    if (flight) run->flight = node_flight_loop(flight);
    const SessionShared shared = {.config = &o->config,
                                  .survey = &made->survey,
                                  .catalog = made->catalog,
                                  .world = &made->world,
                                  .pool = made->pool,
                                  .unix_s = chosen.unix_s,
                                  .bands = run->bands,
                                  .no_skip = o->no_skip,
                                  .live = o->command == COMMAND_RUN,
                                  .sensors = &run->sensors,
                                  .instruments = instrument_kinds,
                                  .contact = made->contact,
                                  .config_sha256 = run->config_sha256,
                                  .publish = run->publish,
                                  .user = run->user,
                                  .dis = run->send ? &dis : NULL,
                                  .note = run->note,
                                  .notes = run->view.notes,
                                  .choose = run->choose,
                                  .clock = run->clock,
                                  .cigi = run->cigi,
                                  .flight = run->flight,
                                  .save_count = o->save_count,
                                  .save = o->save,
                                  .several = o->host_count > 1,
                                  .isa = o->isa,
                                  .woods = made->woods.on ? &made->woods.config : NULL,
                                  .scenery = &made->scenery};
    const FrameGrid     grid = grid_of(&chosen.plan);
    status = session_open(&session, &shared, &chosen.plan, player, out);
    if (status != STATUS_OK) goto done;
    status = run->frames(run, session, player, &chosen.plan, &grid);
    if (status == STATUS_OK && dis_log_failed(&run->view)) status = STATUS_IO;
    snprintf(host_text, sizeof host_text, "%s", session_host(session));
    const Status closed = session_close(session, &result);
    if (status == STATUS_OK) status = closed;
    const Status landed = node_flight_close(flight);
    if (status == STATUS_OK) status = landed;
    if (flight) run->flight = NULL;
    flight = NULL;
    if (run->live) {
        run->live->files_failed = (uint64_t)result.files_failed;
        run->live->files_left_out = (uint64_t)result.files_left_out;
    }
    if (result.frames > 0 || (result.begun && (run->live || run->stopped))) {
        const RunEnd end = {.folder = out,
                            .host = host_text,
                            .state = status != STATUS_OK ? "failed"
                                     : run->stopped      ? "stopped"
                                                         : "complete",
                            .choices = &chosen.choices,
                            .result = &result,
                            .woods = &made->woods,
                            .heard = o->config.exercise.causal ? player_counters(player) : &made->survey.counters};
        const Status written = run_conclude(run, &end);
        if (status == STATUS_OK) status = written;
    }

done:
    node_flight_close(flight);
    session_result_free(&result);
    player_destroy(player);
    return status;
}

Status run_unheard(Run *run)
{
    static const WoodsChoice   woods = {0};
    static const DisCounters   heard = {0};
    static const SessionResult result = {0};
    const Options             *o = &run->options;
    char                       earlier[frame_path_size];
    if (frame_files_earlier(earlier, o->out)) return STATUS_OK;
    const Status status = frame_files_folder(o->out);
    const RunEnd end = {.folder = o->out,
                        .host = o->config.exercise.host,
                        .state = run->stopped ? "stopped" : "failed",
                        .choices = &run->choices,
                        .result = &result,
                        .heard = &heard,
                        .woods = &woods};
    return status == STATUS_OK ? run_write(run, &end) : status;
}

/* ---- the addresses of the configuration ------------------------------------------------------------- */

DisUdpConfig run_network(const Config *config)
{
    DisUdpConfig udp = dis_udp_default_config();
    if (config->exercise.port != dis_port_default && config->exercise.port != dis_port_any)
        udp.port = config->exercise.port;
    _Static_assert(sizeof udp.address == sizeof config->network.address, "one address");
    memcpy(udp.address, config->network.address, sizeof udp.address);
    memcpy(udp.interface, config->network.interface, sizeof udp.interface);
    udp.ttl = config->network.ttl;
    udp.queue_octets = config->network.queue_mb << 20;
    return udp;
}

void run_network_to(char out[run_network_to_size], const DisUdpConfig *udp)
{
    snprintf(out, run_network_to_size, "%s port %d", *udp->address ? udp->address : "255.255.255.255", udp->port);
}
