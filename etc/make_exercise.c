/* etc/make_exercise.c: writes a small recorded exercise, as a simulator with the usual habits sends one.
 *
 *     make_exercise demo demo.pcap
 *
 * A column of three tanks and two trucks drives over gentle ground, turrets turning. A helicopter hovers
 * 2.5 km off, fires a wire-guided missile at the last truck, and hits it some 8 s later. Entity States go
 * out when dead reckoning (algorithm 4) has left the truth by 1 m or 3 degrees, and every 5 s; positions
 * are those of the entities' bases. Everything is a pure function of the options. */
#include "dis/entity_state.h"
#include "dis/simulation_management.h"
#include "dis/warfare.h"
#include "entities/dead_reckoning.h"
#include "terrain/local_frame.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

static const double duration_s = 30, tick_s = 1 / 60.0, fire_s = 12;
static const double heartbeat_s = 5, threshold_m = 1, threshold_rad = 3 * 0.017453292519943295769;
static const double first_round_s = 4, between_rounds_s = 6, round_flight_s = 0.6;
static const double stand_off_m = 2500, hover_m = 90, spacing_m = 40;

enum { site = 1, application = 3001, tank_count = 3, vehicle_count = 5, target_vehicle = 4, helicopter = 5, missile = 6,
       entity_count = 7 };

static const DisEntityType tank_type = {1, 1, 222, 1, 1, 1, 0}, truck_type = {1, 1, 222, 7, 1, 0, 0},
                           helicopter_type = {1, 2, 225, 20, 1, 0, 0}, missile_type = {2, 2, 225, 1, 1, 3, 0};

/* Appearance bits of IEEE 1278.1: land 15 flaming, 3-4 damage, 5-6 smoke, 7-8 dust, 22 power plant; 23 deactivated. */
static const uint32_t small_trail = 1u << 7, medium_trail = 2u << 7;
static const uint32_t deactivated = 1u << 23, engine_on = 1u << 22, wrecked = 1u << 15 | 3u << 3 | 1u << 5;

typedef struct Options {
    const char *name, *path;
    int         version;
    const char *datagrams; /* folder; NULL: none */
    bool        bundle, absolute;
    double      lat_deg, lon_deg, height_m, silent_s, stamp_s, clock_unix_s;
    uint64_t    seed;
} Options;

/* ---- the capture file: pcap with nanoseconds, Ethernet, IPv4, UDP ------------------------- */

typedef struct Capture {
    FILE       *file;
    double      epoch_unix_s;
    const char *datagrams; /* folder for each datagram as a file of its own; NULL: none */
    int         count;
} Capture;

static void put_u16(uint8_t *at, unsigned v)
{
    at[0] = (uint8_t)(v >> 8);
    at[1] = (uint8_t)v;
}

static bool capture_open(Capture *capture, const char *path, double epoch_unix_s)
{
    /* magic (nanoseconds), version 2.4, zone, accuracy, longest packet, link layer 1: machine order */
    const uint32_t header[6] = {0xa1b23c4du, 4u << 16 | 2, 0, 0, 65535, 1};
    capture->epoch_unix_s = epoch_unix_s;
    capture->file = fopen(path, "wb");
    return capture->file && fwrite(header, sizeof header, 1, capture->file) == 1;
}

/* DATAGRAMS/NNNN.pdu: what a fuzzer begins with. */
static bool datagram_file(const Capture *capture, const uint8_t *bytes, size_t count)
{
    char path[4096];
    if (!capture->datagrams) return true;
    const int octets = snprintf(path, sizeof path, "%s/%04d.pdu", capture->datagrams, capture->count);
    if (octets < 0 || octets >= (int)sizeof path) return false;
    FILE *file = fopen(path, "wb");
    if (!file) return false;
    const bool ok = count == 0 || fwrite(bytes, count, 1, file) == 1;
    return fclose(file) == 0 && ok;
}

/* One datagram to the broadcast address of the loopback network. */
static bool capture_datagram(Capture *capture, double t_s, const uint8_t *bytes, size_t count)
{
    uint8_t frame[14 + 20 + 8] = {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2, 0, 0, 0, 0, 1, 8, 0};
    uint8_t *ip = frame + 14, *udp = ip + 20;
    static const uint8_t from_to[8] = {127, 0, 0, 1, 127, 255, 255, 255};

    ip[0] = 0x45;
    put_u16(ip + 2, (unsigned)(28 + count));
    ip[8] = 64;
    ip[9] = 17;
    memcpy(ip + 12, from_to, sizeof from_to);
    unsigned sum = 0;
    for (int i = 0; i < 20; i += 2) sum += (unsigned)ip[i] << 8 | ip[i + 1];
    while (sum >> 16) sum = (sum & 0xffff) + (sum >> 16);
    put_u16(ip + 10, ~sum & 0xffff);
    put_u16(udp, dis_port);
    put_u16(udp + 2, dis_port);
    put_u16(udp + 4, (unsigned)(8 + count)); /* checksum 0: none */

    /* nanoseconds from the exercise time alone: at Unix size a double has but 0.2 us */
    const uint64_t ns = (uint64_t)llround(t_s * 1e9) + (uint64_t)llround(fmod(capture->epoch_unix_s, 1) * 1e9);
    const uint32_t length = (uint32_t)(sizeof frame + count);
    capture->count++;
    if (!datagram_file(capture, bytes, count)) return false;
    const uint32_t record[4] = {(uint32_t)(floor(capture->epoch_unix_s) + (double)(ns / 1000000000u)),
                                (uint32_t)(ns % 1000000000u), length, length};
    return fwrite(record, sizeof record, 1, capture->file) == 1 && fwrite(frame, sizeof frame, 1, capture->file) == 1 &&
           (count == 0 || fwrite(bytes, count, 1, capture->file) == 1);
}

/* ---- the scene: where everybody is at any time -------------------------------------------- */

typedef struct Scene {
    Options    options;
    LocalFrame frame;
    double     heading_rad;      /* of the column, anticlockwise from east */
    double     bearing_rad;      /* from the target to the helicopter, likewise */
    double     phase[8];         /* of everything that swings */
    double     impact_s;
    double     launch_ecef[3], impact_ecef[3];
    bool       ground_impact;    /* nobody there to be hit */
} Scene;

/* Height of the ground above the ellipsoid, m: swells of 1.5 m, slopes below 2.4 %, so that a line that comes
 * down at 3.6 % (90 m from 2500 m) is never masked. */
static double ground_height(const Scene *scene, double x_m, double y_m)
{
    return scene->options.height_m + 1.5 * sin(x_m / 66 + scene->phase[0]) * cos(y_m / 95 + scene->phase[1]);
}

/* `above_m` over the ground at (x, y) of the tangent plane. */
static void ground_point(double p_ecef[3], const Scene *scene, double x_m, double y_m, double above_m)
{
    const double flat_enu[3] = {x_m, y_m, 0};
    Geodetic     place;
    ecef_from_enu(p_ecef, &scene->frame, flat_enu);
    if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return;
    place.h_m = ground_height(scene, x_m, y_m) + above_m;
    ecef_from_geodetic(p_ecef, NULL, &place);
}

/* Way made good by vehicle k, m: 8 m/s and a little unsteady; once hit it rolls out in 2 s. */
static double way_m(const Scene *scene, int k, double t_s)
{
    const double lead_m = spacing_m * (vehicle_count - 1 - k);
    if (k != target_vehicle || t_s <= scene->impact_s)
        return lead_m + 8 * t_s + 3 * sin(0.25 * t_s + scene->phase[2]);
    const double after_s = fmin(t_s - scene->impact_s, 2);
    const double speed_mps = 8 + 0.75 * cos(0.25 * scene->impact_s + scene->phase[2]);
    return way_m(scene, k, scene->impact_s) + speed_mps * (after_s - 0.25 * after_s * after_s);
}

/* The road: straight on the whole, winding by 12 m. */
static void road(double xy_m[2], const Scene *scene, double way)
{
    const double along = way - 200, aside = 12 * sin(way / 60 + scene->phase[3]);
    const double c = cos(scene->heading_rad), s = sin(scene->heading_rad);
    xy_m[0] = c * along - s * aside;
    xy_m[1] = s * along + c * aside;
}

/* Body axes from forward and up, columns x forward, y right, z down. */
static void axes_from(double r_ecef_from_body[9], const double forward[3], const double up[3])
{
    double x[3], y[3], z[3];
    v3_normalize(x, forward);
    v3_cross(y, x, up);
    v3_normalize(y, y);
    v3_cross(z, x, y);
    for (int i = 0; i < 3; i++) {
        r_ecef_from_body[3 * i] = x[i];
        r_ecef_from_body[3 * i + 1] = y[i];
        r_ecef_from_body[3 * i + 2] = z[i];
    }
}

static void vehicle_pose(double p_ecef[3], double r_ecef_from_body[9], const Scene *scene, int k, double t_s)
{
    /* attitude from points of the ground half a vehicle's length away: a hull bridges what is shorter */
    static const double half_m = 2;
    const double way = way_m(scene, k, t_s);
    double at[2], before[2], after[2], a[3], b[3], forward[3], left[3], up[3];
    road(at, scene, way);
    road(before, scene, way - half_m);
    road(after, scene, way + half_m);
    ground_point(p_ecef, scene, at[0], at[1], 0);

    ground_point(a, scene, after[0], after[1], 0);
    ground_point(b, scene, before[0], before[1], 0);
    v3_sub(forward, a, b);
    const double dx = 0.5 * (after[0] - before[0]), dy = 0.5 * (after[1] - before[1]);
    ground_point(a, scene, at[0] - dy, at[1] + dx, 0);
    ground_point(b, scene, at[0] + dy, at[1] - dx, 0);
    v3_sub(left, a, b);
    v3_cross(up, forward, left);
    axes_from(r_ecef_from_body, forward, up);
}

static void up_at(double up[3], const double p_ecef[3])
{
    Geodetic place;
    double   p[3], r[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1};
    if (geodetic_from_ecef(&place, p_ecef) == STATUS_OK) ecef_from_geodetic(p, r, &place);
    for (int i = 0; i < 3; i++) up[i] = r[3 * i + 2];
}

/* Hovering, swaying by 0.4 m, nose on the place of the impact and level but for a slow nod. */
static void helicopter_pose(double p_ecef[3], double r_ecef_from_body[9], const Scene *scene, double t_s)
{
    double road_m[2], up[3], ahead[3], right[3];
    road(road_m, scene, way_m(scene, target_vehicle, fire_s));
    ground_point(p_ecef, scene,
                 road_m[0] + stand_off_m * cos(scene->bearing_rad) + 0.4 * sin(0.9 * t_s + scene->phase[4]),
                 road_m[1] + stand_off_m * sin(scene->bearing_rad), hover_m + 0.4 * sin(0.7 * t_s + scene->phase[5]));
    ground_point(ahead, scene, road_m[0], road_m[1], 0);
    up_at(up, p_ecef);
    v3_sub(ahead, ahead, p_ecef);
    v3_cross(right, ahead, up);
    v3_cross(ahead, up, right); /* level */
    v3_normalize(ahead, ahead);
    v3_add_scaled(ahead, ahead, 0.02 * sin(0.5 * t_s + scene->phase[5]), up);
    axes_from(r_ecef_from_body, ahead, up);
}

/* A wire-guided missile's way: thrown out at 65 m/s, to some 340 m/s within two seconds, then slowing. */
static double flown_m(double flight_s)
{
    static const double thrown_mps = 65, gain_mps = 280, rise_s = 0.6, drag_mps2 = 5;
    return thrown_mps * flight_s + gain_mps * (flight_s - rise_s * (1 - exp(-flight_s / rise_s))) -
           0.5 * drag_mps2 * flight_s * flight_s;
}

static void missile_position(double p_ecef[3], const Scene *scene, double t_s)
{
    double line[3], up[3], right[3];
    v3_sub(line, scene->impact_ecef, scene->launch_ecef);
    const double f = flown_m(t_s - fire_s) / v3_length(line);
    /* above the line of sight and weaving about it, both dying out towards either end */
    const double bump = f > 0 && f < 1 ? 16 * f * f * (1 - f) * (1 - f) : 0;
    up_at(up, scene->launch_ecef);
    v3_cross(right, line, up);
    v3_normalize(right, right);
    v3_add_scaled(p_ecef, scene->launch_ecef, f, line);
    v3_add_scaled(p_ecef, p_ecef, 3 * bump, up);
    v3_add_scaled(p_ecef, p_ecef, 0.8 * bump * sin(6 * pi_rad * f + scene->phase[6]), right);
}

static void missile_pose(double p_ecef[3], double r_ecef_from_body[9], const Scene *scene, double t_s)
{
    static const double h_s = 0.005;
    double a[3], b[3], up[3];
    missile_position(p_ecef, scene, t_s);
    missile_position(a, scene, t_s + h_s);
    missile_position(b, scene, t_s - h_s);
    v3_sub(a, a, b);
    up_at(up, p_ecef);
    axes_from(r_ecef_from_body, a, up);
}

static void pose_at(double p_ecef[3], double r_ecef_from_body[9], const Scene *scene, int entity, double t_s)
{
    if (entity < vehicle_count)
        vehicle_pose(p_ecef, r_ecef_from_body, scene, entity, t_s);
    else if (entity == helicopter)
        helicopter_pose(p_ecef, r_ecef_from_body, scene, t_s);
    else
        missile_pose(p_ecef, r_ecef_from_body, scene, t_s);
}

/* Velocity, acceleration and body rates as differences of the pose, so that they belong to it. */
static void kinematics_at(Kinematics *k, const Scene *scene, int entity, double t_s)
{
    static const double h_s = 0.01;
    double before[3], after[3], r_before[9], r_after[9], change[9], spin[9];
    *k = (Kinematics){.algorithm = 4};
    pose_at(k->p_ecef, k->r_ecef_from_body, scene, entity, t_s);
    pose_at(before, r_before, scene, entity, t_s - h_s);
    pose_at(after, r_after, scene, entity, t_s + h_s);
    for (int i = 0; i < 3; i++) {
        k->v_mps[i] = (after[i] - before[i]) / (2 * h_s);
        k->a_mps2[i] = (after[i] - k->p_ecef[i] - (k->p_ecef[i] - before[i])) / (h_s * h_s);
    }
    for (int i = 0; i < 9; i++) change[i] = (r_after[i] - r_before[i]) / (2 * h_s);
    m3_tmul(spin, k->r_ecef_from_body, change); /* dR/dt = R skew(w) */
    k->w_body_rps[0] = 0.5 * (spin[7] - spin[5]);
    k->w_body_rps[1] = 0.5 * (spin[2] - spin[6]);
    k->w_body_rps[2] = 0.5 * (spin[3] - spin[1]);
}

/* Turret azimuth and gun elevation of a tank, rad and rad/s: azimuth, rate, elevation, rate. */
static void turret_at(double value[4], const Scene *scene, int k, double t_s)
{
    const double swing = 0.35 + 0.08 * k, phase = scene->phase[k];
    value[0] = 1.1 * sin(swing * t_s + phase);
    value[1] = 1.1 * swing * cos(swing * t_s + phase);
    value[2] = 0.06 + 0.05 * sin(0.6 * t_s + phase);
    value[3] = 0.03 * cos(0.6 * t_s + phase);
}

static bool has_vehicles(const Scene *scene) { return strcmp(scene->options.name, "no-vehicles") != 0; }
static bool has_missile(const Scene *scene) { return strcmp(scene->options.name, "no-missile") != 0; }
static bool has_guns(const Scene *scene) { return strcmp(scene->options.name, "guns") == 0; }

static bool alive(const Scene *scene, int entity, double t_s)
{
    if (entity < vehicle_count) return has_vehicles(scene);
    if (entity == missile) return has_missile(scene) && t_s >= fire_s && t_s < scene->impact_s;
    return true;
}

static bool scene_build(Scene *scene, const Options *options)
{
    *scene = (Scene){.options = *options, .impact_s = INFINITY};
    scene->ground_impact = !has_vehicles(scene);
    const Geodetic origin = {options->lat_deg * rad_per_deg, options->lon_deg * rad_per_deg, options->height_m};
    if (local_frame_at(&scene->frame, &origin) != STATUS_OK) return false;
    for (uint64_t i = 0; i < 8; i++) scene->phase[i] = 2 * pi_rad * random_uniform(options->seed, 1, 0, i);
    scene->heading_rad = 2 * pi_rad * random_uniform(options->seed, 2, 0, 0);
    /* from the side, a quarter ahead or behind: not straight along the road, where vehicles hide each other */
    scene->bearing_rad = scene->heading_rad + (random_uniform(options->seed, 2, 0, 1) < 0.5 ? -1 : 1) *
                                                  (0.9 + 0.9 * random_uniform(options->seed, 2, 0, 2));

    double r[9], up[3], line[3];
    helicopter_pose(scene->launch_ecef, r, scene, fire_s);
    up_at(up, scene->launch_ecef);
    v3_add_scaled(scene->launch_ecef, scene->launch_ecef, -0.8, up); /* under the stub wing */

    /* when it gets there depends on where the target is by then: 8 m/s against 300, so each round is 40 times nearer */
    double at_s = fire_s + 8;
    for (int i = 0; i < 30; i++) {
        vehicle_pose(scene->impact_ecef, r, scene, target_vehicle, at_s);
        if (!scene->ground_impact) v3_add_scaled(scene->impact_ecef, scene->impact_ecef, 1.2, up);
        v3_sub(line, scene->impact_ecef, scene->launch_ecef);
        double low_s = 0, high_s = 20;
        for (int j = 0; j < 60; j++) {
            const double middle_s = 0.5 * (low_s + high_s);
            if (flown_m(middle_s) < v3_length(line))
                low_s = middle_s;
            else
                high_s = middle_s;
        }
        at_s = fire_s + low_s;
    }
    if (has_missile(scene)) scene->impact_s = at_s;
    return true;
}

/* ---- what is said about it ---------------------------------------------------------------- */

enum { datagram_capacity = 1400 };

typedef struct Sender {
    const Scene *scene;
    Capture      capture;
    bool         failed;
    size_t       pending; /* octets of a bundle not yet sent */
    uint8_t      bundle[datagram_capacity];
    double       bundle_s;
    Kinematics   said[entity_count]; /* as last sent */
    double       said_s[entity_count], said_turret[tank_count][4];
    uint32_t     said_appearance[entity_count];
    bool         known[entity_count];
} Sender;

static const struct {
    uint16_t             number;
    const char          *marking; /* 11 octets at most */
    const DisEntityType *type;
} cast[entity_count] = {
    {11, "Tank 11", &tank_type},   {12, "Tank 12", &tank_type},       {13, "Tank 13", &tank_type},
    {21, "Truck 21", &truck_type}, {22, "Truck 22", &truck_type},     {31, "Heli 31", &helicopter_type},
    {41, "Missile 41", &missile_type},
};

static DisEntityId id_of(int entity) { return (DisEntityId){site, application, cast[entity].number}; }

static uint32_t stamp(const Scene *scene, double t_s)
{
    const double past_s = fmod(scene->options.stamp_s + t_s, 3600);
    return (uint32_t)(past_s / 3600 * 2147483648.0) << 1 | scene->options.absolute;
}

static DisHeader header_of(const Scene *scene, uint8_t type, uint8_t family, double t_s)
{
    return (DisHeader){.version = (uint8_t)scene->options.version, .exercise = 1, .type = type, .family = family,
                       .timestamp = stamp(scene, t_s), .status = scene->options.version == 7 ? 6 : 0};
}

static void datagram(Sender *sender, double t_s, const uint8_t *bytes, size_t count)
{
    if (!capture_datagram(&sender->capture, t_s, bytes, count)) sender->failed = true;
}

static void flush_bundle(Sender *sender)
{
    if (sender->pending) datagram(sender, sender->bundle_s, sender->bundle, sender->pending);
    sender->pending = 0;
}

/* A PDU that a receiver of pictures only walks over: Attribute (72) in version 7, else Data (20). */
static size_t put_filler(uint8_t *out, const Scene *scene, double t_s)
{
    const bool   v7 = scene->options.version == 7;
    const size_t octets = v7 ? 32 : 40;
    const uint32_t when = stamp(scene, t_s);
    memset(out, 0, octets);
    out[0] = (uint8_t)scene->options.version;
    out[1] = 1;
    out[2] = v7 ? 72 : 20;
    out[3] = v7 ? 1 : 5;
    put_u16(out + 4, when >> 16);
    put_u16(out + 6, when & 0xffff);
    put_u16(out + 8, (unsigned)octets);
    put_u16(out + 12, site);
    put_u16(out + 14, application);
    return octets;
}

static void send_pdu(Sender *sender, double t_s, const uint8_t *bytes, size_t count)
{
    if (!sender->scene->options.bundle) {
        datagram(sender, t_s, bytes, count);
        return;
    }
    if (sender->pending && (sender->bundle_s != t_s || sender->pending + count + 40 > datagram_capacity))
        flush_bundle(sender);
    memcpy(sender->bundle + sender->pending, bytes, count);
    sender->pending += count;
    sender->pending += put_filler(sender->bundle + sender->pending, sender->scene, t_s);
    sender->bundle_s = t_s;
}

static uint32_t appearance_of(const Scene *scene, int entity, double t_s)
{
    if (entity == target_vehicle && t_s >= scene->impact_s) return wrecked;
    if (entity < tank_count) return engine_on | medium_trail;
    if (entity < helicopter) return engine_on | small_trail;
    if (entity == missile) return t_s < fire_s + 0.5 ? 1u << 16 : 0; /* launch flash */
    return engine_on;
}

static void articulation(DisEntityState *es, const double turret[4])
{
    static const uint32_t parameter[4] = {4096 + 11, 4096 + 12, 4416 + 13, 4416 + 14};
    es->variable_count = 4;
    for (int i = 0; i < 4; i++)
        es->variable[i] = (DisVariableParameter){.record_type = dis_variable_articulated, .attached_to = i / 2,
                                                 .parameter = parameter[i], .value = (float)turret[i]};
}

static void entity_state(DisEntityState *es, const Scene *scene, int entity, const Kinematics *k, uint32_t appearance,
                         double t_s)
{
    double psi_rad, theta_rad, phi_rad;
    *es = (DisEntityState){.header = header_of(scene, dis_pdu_entity_state, 1, t_s), .id = id_of(entity),
                           .force = entity < vehicle_count ? 2 : 1, .appearance = appearance,
                           .dead_reckoning = (uint8_t)k->algorithm, .marking_set = 1};
    es->type = es->alternative_type = *cast[entity].type;
    memcpy(es->marking, cast[entity].marking, strlen(cast[entity].marking));
    euler_from_r_ecef_from_body(&psi_rad, &theta_rad, &phi_rad, k->r_ecef_from_body);
    es->psi_rad = (float)psi_rad;
    es->theta_rad = (float)theta_rad;
    es->phi_rad = (float)phi_rad;
    for (int i = 0; i < 3; i++) {
        es->p_ecef[i] = k->p_ecef[i];
        es->velocity_mps[i] = (float)k->v_mps[i];
        es->acceleration_mps2[i] = (float)k->a_mps2[i];
        es->angular_rate_rps[i] = (float)k->w_body_rps[i];
    }
}

static void send_entity(Sender *sender, int entity, const Kinematics *k, uint32_t appearance, double t_s)
{
    static DisEntityState es;
    static uint8_t        bytes[8192];
    entity_state(&es, sender->scene, entity, k, appearance, t_s);
    if (entity < tank_count) {
        turret_at(sender->said_turret[entity], sender->scene, entity, t_s);
        articulation(&es, sender->said_turret[entity]);
    }
    send_pdu(sender, t_s, bytes, dis_encode_entity_state(bytes, sizeof bytes, &es));
    sender->said[entity] = *k;
    sender->said_s[entity] = t_s;
    sender->said_appearance[entity] = appearance;
    sender->known[entity] = true;
}

/* Whether what was said last has become wrong. */
static bool due(const Sender *sender, int entity, const Kinematics *truth, uint32_t appearance, double t_s)
{
    if (!sender->known[entity] || appearance != sender->said_appearance[entity]) return true;
    const double age_s = t_s - sender->said_s[entity];
    if (age_s >= heartbeat_s - 0.5 * tick_s) return true;
    Motion believed;
    double off[3], turn[9];
    dead_reckon(&believed, &sender->said[entity], age_s);
    v3_sub(off, believed.p_ecef, truth->p_ecef);
    if (!(v3_length(off) < threshold_m)) return true;
    m3_tmul(turn, believed.r_ecef_from_body, truth->r_ecef_from_body);
    if (!((turn[0] + turn[4] + turn[8] - 1) / 2 > cos(threshold_rad))) return true;
    if (entity < tank_count) {
        double now[4];
        const double *said = sender->said_turret[entity];
        turret_at(now, sender->scene, entity, t_s);
        for (int i = 0; i < 4; i += 2)
            if (!(fabs(said[i] + said[i + 1] * age_s - now[i]) < threshold_rad)) return true;
    }
    return false;
}

static void send_shot(Sender *sender, bool fire, double t_s)
{
    static DisDetonation detonation;
    static uint8_t       bytes[512];
    const Scene      *scene = sender->scene;
    const DisEntityId none = {0, 0, 0}, target = scene->ground_impact ? none : id_of(target_vehicle);
    const DisEventId  event = {site, application, 1};
    const DisDescriptor descriptor = {missile_type, 1000, 1000, 1, 0}; /* high explosive, contact fuse */
    Kinematics k, at_target;
    kinematics_at(&k, scene, missile, t_s);
    if (fire) {
        double line[3];
        DisFire pdu = {.header = header_of(scene, dis_pdu_fire, 2, t_s), .firing = id_of(helicopter), .target = target,
                       .munition = id_of(missile), .event = event, .descriptor = descriptor};
        v3_sub(line, scene->impact_ecef, scene->launch_ecef);
        pdu.range_m = (float)v3_length(line);
        for (int i = 0; i < 3; i++) pdu.p_ecef[i] = k.p_ecef[i], pdu.velocity_mps[i] = (float)k.v_mps[i];
        send_pdu(sender, t_s, bytes, dis_encode_fire(bytes, sizeof bytes, &pdu));
        return;
    }
    detonation = (DisDetonation){.header = header_of(scene, dis_pdu_detonation, 2, t_s), .firing = id_of(helicopter),
                                 .target = target, .munition = id_of(missile), .event = event, .descriptor = descriptor,
                                 .result = scene->ground_impact ? dis_result_ground_impact : dis_result_entity_impact};
    double off[3], off_body[3];
    kinematics_at(&at_target, scene, target_vehicle, t_s);
    v3_sub(off, k.p_ecef, at_target.p_ecef);
    m3_tmul_v3(off_body, at_target.r_ecef_from_body, off);
    for (int i = 0; i < 3; i++) {
        detonation.p_ecef[i] = k.p_ecef[i];
        detonation.velocity_mps[i] = (float)k.v_mps[i];
        if (!scene->ground_impact) detonation.p_target_m[i] = (float)off_body[i];
    }
    send_pdu(sender, t_s, bytes, dis_encode_detonation(bytes, sizeof bytes, &detonation));
    if (!(sender->scene->options.silent_s > 0)) send_entity(sender, missile, &k, deactivated, t_s);
}

/* A round of the first tank's gun: 0.6 s to a place 600 m to the side of the road. No Entity State of its own. */
static void send_round(Sender *sender, int number, bool fire, double t_s)
{
    static DisDetonation detonation;
    static uint8_t       bytes[512];
    static const DisEntityType round_type = {2, 2, 225, 2, 1, 1, 0};
    static const double  muzzle_mps = 1000, barrel_m = 6, trunnion_m = 2;
    const Scene         *scene = sender->scene;
    const double         fired_s = fire ? t_s : t_s - round_flight_s, along = scene->heading_rad + 0.5 * pi_rad;
    const DisEventId     event = {site, application, (uint16_t)(100 + number)};
    const DisDescriptor  descriptor = {round_type, 1000, 1000, 1, 0};
    double               muzzle[3], end[3], way[3], xy_m[2], up[3];
    Kinematics           tank;

    kinematics_at(&tank, scene, 0, fired_s);
    road(xy_m, scene, way_m(scene, 0, fired_s));
    ground_point(end, scene, xy_m[0] + 600 * cos(along) + 30 * number, xy_m[1] + 600 * sin(along), 0);
    up_at(up, tank.p_ecef);
    v3_add_scaled(muzzle, tank.p_ecef, trunnion_m, up);
    v3_sub(way, end, muzzle);
    v3_normalize(way, way);
    v3_add_scaled(muzzle, muzzle, barrel_m, way);
    if (fire) {
        DisFire pdu = {.header = header_of(scene, dis_pdu_fire, 2, t_s), .firing = id_of(0), .event = event,
                       .descriptor = descriptor, .range_m = 600};
        for (int i = 0; i < 3; i++) pdu.p_ecef[i] = muzzle[i], pdu.velocity_mps[i] = (float)(muzzle_mps * way[i]);
        send_pdu(sender, t_s, bytes, dis_encode_fire(bytes, sizeof bytes, &pdu));
        return;
    }
    detonation = (DisDetonation){.header = header_of(scene, dis_pdu_detonation, 2, t_s), .firing = id_of(0),
                                 .event = event, .descriptor = descriptor, .result = dis_result_ground_impact};
    for (int i = 0; i < 3; i++) detonation.p_ecef[i] = end[i], detonation.velocity_mps[i] = (float)(muzzle_mps * way[i]);
    send_pdu(sender, t_s, bytes, dis_encode_detonation(bytes, sizeof bytes, &detonation));
}

static void send_start(Sender *sender)
{
    uint8_t bytes[64];
    const double clock_s = sender->scene->options.clock_unix_s;
    const DisClockTime clock = {(uint32_t)(clock_s / 3600),
                                (uint32_t)(fmod(clock_s, 3600) / 3600 * 2147483648.0) << 1 | 1};
    const DisStartResume start = {.header = header_of(sender->scene, dis_pdu_start_resume, 5, 0),
                                  .originating = {site, application, 0}, .receiving = {65535, 65535, 65535},
                                  .real_world = clock, .simulation = clock, .request = 1};
    send_pdu(sender, 0, bytes, dis_encode_start_resume(bytes, sizeof bytes, &start));
}

/* ---- what goes wrong on real networks ----------------------------------------------------- */

enum { bad_kinds = 14 };

/* One bad datagram of each kind, in turn. Every one must be dropped and counted, or taken for what it is
 * worth; none may disturb the others. */
static void send_bad(Sender *sender, int kind, double t_s)
{
    static DisEntityState es;
    static uint8_t        bytes[8192];
    Kinematics k;
    kinematics_at(&k, sender->scene, 0, t_s);
    /* those that stand up to scrutiny drive beside the column, not inside its first tank */
    const double right[3] = {k.r_ecef_from_body[1], k.r_ecef_from_body[4], k.r_ecef_from_body[7]};
    v3_add_scaled(k.p_ecef, k.p_ecef, kind == 5 ? 25 : -25, right);
    entity_state(&es, sender->scene, 0, &k, 0, t_s);
    es.id.entity = (uint16_t)(900 + kind);
    switch (kind) {
    case 1: es.p_ecef[1] = NAN; break;
    case 2: memset(es.p_ecef, 0, sizeof es.p_ecef); break;
    case 3: es.velocity_mps[2] = INFINITY; break;
    case 4: es.psi_rad = NAN; break;
    case 5: /* nobody's type, and a marking that means harm */
        es.type = (DisEntityType){9, 9, 999, 99, 9, 9, 9};
        memcpy(es.marking, "\x01\xff\x80<b>\n\r\t\"'", 11);
        break;
    case 7: es.id = (DisEntityId){65535, 65535, 65535}; break;
    case 8: articulation(&es, (const double[4]){NAN, INFINITY, -1e30, 0}); break;
    }
    size_t count = dis_encode_entity_state(bytes, sizeof bytes, &es);
    switch (kind) {
    case 0: put_u16(bytes + 8, 0); break;              /* length field 0 */
    case 6: bytes[0] = 42; break;
    case 9: count = 100; break;                        /* cut short on the way */
    case 10: bytes[19] = 255; break;                   /* more parts than there is room for */
    case 11: bytes[2] = 200; break;                    /* a type that nobody knows */
    case 12:                                           /* noise */
        for (size_t i = 0; i < count; i++) bytes[i] = (uint8_t)(256 * random_uniform(9, 9, (uint32_t)(t_s * 60), i));
        break;
    case 13: count = (size_t)(7 * random_uniform(9, 8, (uint32_t)(t_s * 60), 0)); break; /* 0 .. 6 octets */
    }
    datagram(sender, t_s, bytes, count);
}

/* ---- the exercise ------------------------------------------------------------------------- */

static void play(Sender *sender)
{
    const Scene *scene = sender->scene;
    const bool   bad = strcmp(scene->options.name, "bad-pdus") == 0;
    bool         fired = false, burst = false;
    int          rounds = 0, landed = 0;
    if (!isnan(scene->options.clock_unix_s)) send_start(sender);
    for (int tick = 0; tick * tick_s <= duration_s; tick++) {
        const double t_s = tick * tick_s;
        if (has_missile(scene) && !fired && t_s >= fire_s) {
            send_shot(sender, true, t_s);
            fired = true;
        }
        if (fired && !burst && t_s >= scene->impact_s) {
            send_shot(sender, false, scene->impact_s);
            burst = true;
        }
        if (has_guns(scene) && t_s >= first_round_s + rounds * between_rounds_s) send_round(sender, rounds++, true, t_s);
        if (landed < rounds && t_s >= first_round_s + landed * between_rounds_s + round_flight_s)
            send_round(sender, landed++, false, t_s);
        for (int entity = 0; entity < entity_count; entity++) {
            if (!alive(scene, entity, t_s)) continue;
            if (entity == missile && t_s > scene->impact_s - scene->options.silent_s) continue;
            Kinematics k;
            kinematics_at(&k, scene, entity, t_s);
            const uint32_t appearance = appearance_of(scene, entity, t_s);
            if (due(sender, entity, &k, appearance, t_s)) send_entity(sender, entity, &k, appearance, t_s);
        }
        flush_bundle(sender);
        if (bad && tick % 10 == 5) send_bad(sender, tick / 10 % bad_kinds, t_s);
    }
}

static const char help[] =
    "usage: make_exercise NAME OUT.pcap [options]\n"
    "  writes 30 s of an invented exercise as a capture file\n"
    "names\n"
    "  demo          a column of 3 tanks and 2 trucks; a helicopter hits the last truck with a missile\n"
    "  no-vehicles   the helicopter and its missile, which hits the ground\n"
    "  no-missile    nobody fires\n"
    "  guns          demo, and the first tank fires at the ground beside the road every 6 s\n"
    "  bad-pdus      demo, with malformed PDUs in between\n"
    "  empty         a capture without a packet\n"
    "options\n"
    "  --version 5|6|7   DIS version (7)\n"
    "  --bundle          several PDUs a datagram, and some of types nobody needs\n"
    "  --absolute        absolute time stamps (UTC), captured on 2024-06-21 18:00 (relative)\n"
    "  --stamp S         relative stamps begin S seconds past the hour, 0 .. 3600 (1350)\n"
    "  --clock UNIX_S    a Start/Resume PDU first, with this simulation time\n"
    "  --lat DEG         -89 .. 89 (36)\n"
    "  --lon DEG         -180 .. 180 (-123)\n"
    "  --height M        of its ground above the ellipsoid, -400 .. 8000 (120)\n"
    "  --seed N          another road, another place to fire from (1)\n"
    "  --silent S        the missile sends no Entity State in its last S seconds, 0 .. 8 (0)\n"
    "  --datagrams DIR   each datagram as a file in DIR, too\n";

static bool in_range(const char *option, double value, double low, double high)
{
    if (value >= low && value <= high) return true;
    fprintf(stderr, "make_exercise: --%s takes %g .. %g\n", option, low, high);
    return false;
}

static bool read_options(Options *o, int argc, char **argv)
{
    static const struct option options[] = {{"version", 1, 0, 'v'}, {"bundle", 0, 0, 'b'}, {"absolute", 0, 0, 'a'},
                                            {"stamp", 1, 0, 's'},   {"clock", 1, 0, 'c'},  {"lat", 1, 0, 'y'},
                                            {"lon", 1, 0, 'x'},     {"height", 1, 0, 'h'},  {"silent", 1, 0, 'q'},  {"seed", 1, 0, 'r'},   {"datagrams", 1, 0, 'd'},
                                            {0, 0, 0, 0}};
    *o = (Options){.version = 7, .lat_deg = 36, .lon_deg = -123, .height_m = 120, .stamp_s = 1350, .clock_unix_s = NAN, .seed = 1};
    for (int c, at = 0; (c = getopt_long(argc, argv, "", options, &at)) != -1;) {
        double value = 0;
        if (c == '?') return false;
        if (optarg && !text_to_double(&value, optarg)) value = NAN;
        switch (c) {
        case 'v': o->version = (int)value; if (!in_range("version", value, 5, 7)) return false; break;
        case 'd': o->datagrams = optarg; break;
        case 'b': o->bundle = true; break;
        case 'a': o->absolute = true; break;
        case 's': o->stamp_s = value; if (!in_range("stamp", value, 0, 3600)) return false; break;
        case 'c': o->clock_unix_s = value; if (!in_range("clock", value, 0, 4e9)) return false; break;
        case 'y': o->lat_deg = value; if (!in_range("lat", value, -89, 89)) return false; break;
        case 'x': o->lon_deg = value; if (!in_range("lon", value, -180, 180)) return false; break;
        case 'h': o->height_m = value; if (!in_range("height", value, -400, 8000)) return false; break;
        case 'q': o->silent_s = value; if (!in_range("silent", value, 0, 8)) return false; break;
        case 'r': if (!in_range("seed", value, 0, 1e15)) return false; o->seed = (uint64_t)value; break;
        }
    }
    if (o->absolute) o->stamp_s = 0; /* the capture begins on the hour */
    if (argc - optind != 2) return false;
    o->name = argv[optind];
    o->path = argv[optind + 1];
    static const char *const names[] = {"demo", "no-vehicles", "no-missile", "guns", "bad-pdus", "empty"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(o->name, names[i]) == 0) return true;
    return false;
}

int main(int argc, char **argv)
{
    Options       options;
    static Scene  scene;
    static Sender sender;
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        fputs(help, stdout);
        return 0;
    }
    if (!read_options(&options, argc, argv)) {
        fputs(help, stderr);
        return 2;
    }
    if (!scene_build(&scene, &options)) {
        fprintf(stderr, "make_exercise: no such place: %g, %g\n", options.lat_deg, options.lon_deg);
        return 1;
    }
    sender.scene = &scene;
    /* relative: a round epoch that nobody takes for a date */
    sender.failed = !capture_open(&sender.capture, options.path, options.absolute ? 1718992800 : 1000000000);
    sender.capture.datagrams = options.datagrams;
    if (!sender.failed && strcmp(options.name, "empty") != 0) play(&sender);
    const int reason = errno;
    if (sender.capture.file && fclose(sender.capture.file) != 0) sender.failed = true;
    if (sender.failed) {
        fprintf(stderr, "make_exercise: cannot write %s: %s\n", options.path, strerror(reason ? reason : errno));
        return 1;
    }
    return 0;
}
