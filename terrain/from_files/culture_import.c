/* terrain/from_files/culture_import.c: from features of files to records: places, outlines and lines in ENU, base
 * heights, and what is left out. */
#include "terrain/culture/courtyards.h"
#include "terrain/from_files/culture_import_private.h"

#include <stdlib.h>

typedef struct Import {
    const CultureFiles *from;
    Culture            *culture;
    CultureReport      *report;
    CultureRules        rules;
    double (*corner_m)[2]; /* [vector_most_corners + 1] of the part at hand */
    double (*ring_m)[2];   /* [vector_most_corners] of its inner rings */
    const VectorPart *part;
    CultureFacts      facts;
    CultureKnown      known;
    int               made;      /* records of this part so far */
    int64_t           passed[4]; /* buildings, lines, points, trees that were made and are not kept */
} Import;

/* ---- places ----------------------------------------------------------------------------------------- */

static double ground_at(const CultureFiles *from, double x_m, double y_m)
{
    return from->ground ? from->ground(from->user, x_m, y_m) : 0;
}

/* The vertical of a place leans against the origin's by its distance over the Earth's radius: 16 km away 500 m of
 * height are 1.25 m of ENU. So the place is where its vertical meets the ground: from the ellipsoid up along it, until
 * the height is that of the ground there, twice corrected (a micrometre on slopes of 45 degrees). */
void culture_place(double p_m[2], const CultureFiles *from, double lon_rad, double lat_rad)
{
    enum { rounds = 3 };
    const Geodetic place = {.lat_rad = lat_rad, .lon_rad = remainder(lon_rad, 2 * pi_rad)};
    double         p_ecef[3], axes[9], p_enu[3], up[3];
    p_m[0] = p_m[1] = NAN;
    if (ecef_from_geodetic(p_ecef, axes, &place) != STATUS_OK) return;
    enu_from_ecef(p_enu, from->frame, p_ecef);
    m3_tmul_v3(up, from->frame->r_ecef_from_enu, (const double[3]){axes[2], axes[5], axes[8]});
    p_m[0] = p_enu[0], p_m[1] = p_enu[1];
    for (int k = 0; k < rounds && up[2] > 0.1; k++) {
        const double z_m = ground_at(from, p_m[0], p_m[1]);
        if (!isfinite(z_m)) return;
        const double h_m = (z_m - p_enu[2]) / up[2];
        for (int c = 0; c < 2; c++) p_m[c] = p_enu[c] + h_m * up[c];
    }
}

static bool is_within(const CultureFiles *from, const double p_m[2])
{
    return fabs(p_m[0]) <= from->half_m && fabs(p_m[1]) <= from->half_m;
}

static Status leave(Import *i, CultureLeft why)
{
    i->report->left[why]++;
    return STATUS_OK;
}

/* The same for a source and place: OpenStreetMap's number where there is one, else the feature's; and the part's. */
static uint64_t id_of(Import *i)
{
    const int64_t  number[2] = {i->part->part, i->made++};
    const int64_t  own[2] = {i->part->file, i->part->number};
    const uint64_t seed = i->facts.id ? i->facts.id : culture_mix(culture_mix_seed, own, sizeof own);
    return culture_mix(seed, number, sizeof number);
}

/* Takes the last record of a list back where there is one like it. */
static Status take_back(Import *i, KnownList list)
{
    Culture     *c = i->culture;
    int *const   count[] = {&c->buildings, &c->lines, &c->points, &c->trees};
    bool         again = false;
    const Status status = i->from->passes ? STATUS_OK : culture_known_take(&again, &i->known, c, list);
    if (!again) return status;
    if (list == KNOWN_BUILDING) c->corners = c->building[c->buildings - 1].first_corner;
    if (list == KNOWN_LINE) c->corners = c->line[c->lines - 1].first_corner;
    --*count[list];
    return leave(i, CULTURE_LEFT_TWICE);
}

/* ---- buildings -------------------------------------------------------------------------------------- */

double culture_floor_m(const CultureFiles *from, const double (*p)[2], int corners)
{
    enum { most_looks = 64 };
    static const double apart_m = 10;
    double              low_m = INFINITY;
    for (int k = 0; k < corners; k++) {
        const double *a = p[k], *b = p[(k + 1) % corners];
        const int     looks = (int)clamp(ceil(hypot(b[0] - a[0], b[1] - a[1]) / apart_m), 1, most_looks);
        for (int n = 0; n < looks; n++) {
            const double t = (double)n / looks;
            const double z_m = ground_at(from, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
            if (!isfinite(z_m)) return NAN;
            low_m = fmin(low_m, z_m);
        }
    }
    return low_m;
}

static bool outline_is_within(const Import *i)
{
    for (int k = 0; k < i->part->corners; k++)
        if (!is_within(i->from, i->corner_m[k])) return false;
    return true;
}

static bool all_on_earth(const Import *i)
{
    for (int k = 0; k < i->part->corners; k++)
        if (!isfinite(i->corner_m[k][0]) || !isfinite(i->corner_m[k][1])) return false;
    return true;
}

/* Adds the courtyards to the outline of the part: returns the corners that it has then, and how many are in it. */
static int with_courtyards(int *joined, Import *i)
{
    const VectorPart *part = i->part;
    int               first[vector_most_rings + 1], corners = 0, kept = 0;
    for (int r = 0, from = 0; r < part->rings; from += part->ring[r++]) {
        bool whole = true;
        first[kept] = corners;
        for (int k = 0; k < part->ring[r]; k++) {
            const double *lon_lat = part->ring_lon_lat_rad[from + k];
            culture_place(i->ring_m[corners + k], i->from, lon_lat[0], lon_lat[1]);
            whole &= isfinite(i->ring_m[corners + k][0]) && isfinite(i->ring_m[corners + k][1]);
        }
        if (whole) corners += part->ring[r], kept++;
    }
    first[kept] = corners;
    return courtyards_join(i->corner_m, part->corners, (const double(*)[2])i->ring_m, first, kept, joined);
}

static Status add_building(Import *i)
{
    static const double most_m2 = 1e6;
    const double(*p)[2] = (const double(*)[2])i->corner_m;
    CultureReport *r = i->report;
    int            n = i->part->corners, courtyards = 0;
    HeightFrom     from;
    Building       b;
    int            mended = 0;
    if (n == 0 || n > culture_outline_most) return leave(i, CULTURE_LEFT_LARGE);
    if (!all_on_earth(i)) return leave(i, CULTURE_LEFT_CROSSED);
    if (!outline_is_within(i)) return leave(i, CULTURE_LEFT_OUTSIDE);
    if (!(fabs(culture_area_m2(p, n)) <= most_m2)) return leave(i, CULTURE_LEFT_LARGE);
    if (i->part->rings > 0) n = with_courtyards(&courtyards, i);
    const double area_m2 = fabs(culture_area_m2(p, n));
    const double base_m = culture_floor_m(i->from, p, n);
    if (isnan(base_m)) return leave(i, CULTURE_LEFT_OUTSIDE);
    culture_building_make(&b, &from, &mended, &i->facts, p, n, area_m2, courtyards > 0);
    b.id = id_of(i), b.base_m = (float)base_m;
    const int    before = i->culture->buildings, left = i->culture->left_out;
    const Status status = culture_add_building(i->culture, &b, p, n);
    if (status != STATUS_OK) return status;
    if (i->culture->buildings == before) {
        i->culture->left_out = left; /* counted with all others at the end */
        return leave(i, CULTURE_LEFT_CROSSED);
    }
    const Status known = take_back(i, KNOWN_BUILDING);
    if (known != STATUS_OK || i->culture->buildings == before) return known;
    r->height_from[from]++, r->mended += mended, r->unread += i->facts.unread, r->courtyards += courtyards;
    r->built_over += i->part->holes - courtyards;
    i->culture->repaired += mended > 0;
    r->low_m = fmin(r->low_m, (double)b.ridge_m), r->high_m = fmax(r->high_m, (double)b.ridge_m);
    return STATUS_OK;
}

/* ---- lines ------------------------------------------------------------------------------------------ */

static CultureLine line_of(Import *i, const CultureRule *rule)
{
    static const double lane_m = 3.25, most_m = 200;
    const CultureFacts *f = &i->facts;
    CultureLine         l = {.kind = (uint8_t)rule->kind, .surface = (uint8_t)rule->surface};
    double              width_m = rule->width_m, height_m = rule->height_m;
    const bool          way = rule->kind == CULTURE_ROAD || rule->kind == CULTURE_TRACK;
    if (f->lanes >= 1 && f->lanes <= 20 && way) width_m = lane_m * f->lanes;
    if (f->width_m > 0 && f->width_m <= most_m) width_m = f->width_m;
    else if (!isnan(f->width_m)) i->report->mended++;
    if (rule->surface == 0) {
        if (f->height_m > 0 && f->height_m <= 200) height_m = f->height_m;
        else if (!isnan(f->height_m)) i->report->mended++;
    }
    if (way && f->ground > 0) {
        l.surface = (uint8_t)f->ground;
        l.kind = f->ground == SURFACE_ROAD ? CULTURE_ROAD : CULTURE_TRACK;
    }
    if (f->bridge && way) { /* a deck as thick as those of road bridges are; the ground below stays what it is */
        l.kind = CULTURE_BRIDGE, l.surface = SURFACE_NONE;
        height_m = 0.8;
    }
    l.width_m = (float)width_m, l.height_m = (float)height_m;
    return l;
}

/* Whether a piece of a line may reach into the square. */
static bool piece_is_near(const Import *i, const double a[2], const double b[2])
{
    for (int c = 0; c < 2; c++)
        if (!isfinite(a[c]) || !isfinite(b[c]) || fmin(a[c], b[c]) > i->from->half_m ||
            fmax(a[c], b[c]) < -i->from->half_m || fabs(a[c]) > culture_farthest_m || fabs(b[c]) > culture_farthest_m)
            return false;
    return true;
}

/* Adds the runs of pieces that are near, cut into lines of as many corners as one may have. */
static Status add_runs(Import *i, int count, Status (*add)(Import *, const double (*)[2], int))
{
    Status status = STATUS_OK;
    int    first = 0, made = 0;
    for (int k = 1; k <= count && status == STATUS_OK; k++) {
        const bool near = k < count && piece_is_near(i, i->corner_m[k - 1], i->corner_m[k]);
        if (near && k - first + 1 < culture_outline_most) continue;
        const int end = near ? k + 1 : k;
        if (end - first > 1) status = add(i, (const double(*)[2])i->corner_m + first, end - first), made++;
        first = k;
    }
    return status != STATUS_OK || made > 0 ? status : leave(i, CULTURE_LEFT_OUTSIDE);
}

static const CultureRule *rule_of(const Import *i) { return i->facts.what[i->part->shape]; }

static Status add_line(Import *i, const double (*p)[2], int corners)
{
    CultureLine l = line_of(i, rule_of(i));
    l.id = id_of(i);
    const int    before = i->culture->lines;
    const Status status = culture_add_line(i->culture, &l, p, corners);
    return status == STATUS_OK && i->culture->lines > before ? take_back(i, KNOWN_LINE) : status;
}

/* ---- trees ------------------------------------------------------------------------------------------ */

static Status add_tree(Import *i, const double p_m[2], const CultureRule *rule)
{
    const CultureFacts *f = &i->facts;
    CultureTree         t = {.x_m = p_m[0], .y_m = p_m[1], .height_m = (float)rule->height_m, .mark = (uint8_t)f->mark};
    if (!is_within(i->from, p_m)) return leave(i, CULTURE_LEFT_OUTSIDE);
    t.kind = (uint8_t)(rule->kind >= 0 ? rule->kind : f->plant >= 0 ? f->plant : PLANT_ENGLISH_OAK);
    if (f->height_m >= 0.3 && f->height_m <= 100) t.height_m = (float)f->height_m;
    else if (!isnan(f->height_m)) i->report->mended++;
    t.id = id_of(i);
    const int    before = i->culture->trees;
    const Status status = culture_add_tree(i->culture, &t);
    return status == STATUS_OK && i->culture->trees > before ? take_back(i, KNOWN_TREE) : status;
}

/* Which part of a piece is within the square: from t[0] to t[1] of its length; t[0] > t[1]: none. */
static void clip(double t[2], const double a[2], const double b[2], double half_m)
{
    t[0] = 0, t[1] = 1;
    for (int c = 0; c < 2; c++) {
        const double d = b[c] - a[c], low = (-half_m - a[c]) / d, high = (half_m - a[c]) / d;
        if (d != 0) t[0] = fmax(t[0], fmin(low, high)), t[1] = fmin(t[1], fmax(low, high));
        else if (fabs(a[c]) > half_m) t[0] = 2;
    }
}

/* Plants along a line: trees 8 m apart, plants of a hedge 1.2 m. Every step within the square is a record, so that the
 * work has a record's limit. */
static Status add_row(Import *i, const double (*p)[2], int corners)
{
    const CultureRule *rule = rule_of(i);
    const double       apart_m = rule->width_m > 0 ? rule->width_m : 8;
    double             next_m = 0.5 * apart_m;
    Status             status = STATUS_OK;
    for (int k = 0; k + 1 < corners && status == STATUS_OK; k++) {
        const double dx = p[k + 1][0] - p[k][0], dy = p[k + 1][1] - p[k][1], length_m = hypot(dx, dy);
        double       t[2] = {2, 1};
        if (!isfinite(length_m)) continue;
        if (piece_is_near(i, p[k], p[k + 1])) clip(t, p[k], p[k + 1], i->from->half_m);
        const double first = fmax(ceil((t[0] * length_m - next_m) / apart_m), 0);
        for (double at_m = next_m + first * apart_m; at_m < fmin(length_m, t[1] * length_m) && status == STATUS_OK;
             at_m += apart_m) {
            const double place[2] = {p[k][0] + dx * at_m / length_m, p[k][1] + dy * at_m / length_m};
            if (is_within(i->from, place)) status = add_tree(i, place, rule);
        }
        next_m += fmax(ceil((length_m - next_m) / apart_m), 0) * apart_m - length_m;
    }
    return status;
}

/* ---- points ----------------------------------------------------------------------------------------- */

static Status add_point(Import *i, const double p_m[2], double across_m)
{
    const CultureRule  *rule = rule_of(i);
    const CultureFacts *f = &i->facts;
    CulturePoint        q = {.x_m = p_m[0], .y_m = p_m[1], .kind = (uint8_t)rule->kind};
    double              height_m = rule->height_m;
    if (!is_within(i->from, p_m)) return leave(i, CULTURE_LEFT_OUTSIDE);
    const double z_m = ground_at(i->from, p_m[0], p_m[1]);
    if (!isfinite(z_m)) return leave(i, CULTURE_LEFT_OUTSIDE);
    if (f->height_m >= 0.5 && f->height_m <= (double)culture_highest_m) height_m = f->height_m;
    else if (!isnan(f->height_m)) i->report->mended++;
    if (isnan(across_m)) across_m = f->width_m >= 0.1 && f->width_m <= 200 ? f->width_m : rule->width_m;
    q.size_m[0] = q.size_m[1] = (float)across_m, q.size_m[2] = (float)height_m;
    if (rule->kind == CULTURE_SIGN) q.size_m[0] = 0.1f;
    q.base_m = (float)z_m;
    q.heading_rad = isnan(f->direction_rad) ? 0 : (float)f->direction_rad;
    q.id = id_of(i);
    const int    before = i->culture->points;
    const Status status = culture_add_point(i->culture, &q);
    return status == STATUS_OK && i->culture->points > before ? take_back(i, KNOWN_POINT) : status;
}

/* A thing whose outline is drawn stands at its middle, as wide as a circle of its area. */
static Status add_round(Import *i)
{
    const double(*p)[2] = (const double(*)[2])i->corner_m;
    const int n = i->part->corners;
    double    middle[2] = {0, 0};
    if (n == 0 || !all_on_earth(i)) return leave(i, CULTURE_LEFT_CROSSED);
    const double across_m = 2 * sqrt(fabs(culture_area_m2(p, n)) / pi_rad);
    for (int k = 0; k < n; k++)
        for (int c = 0; c < 2; c++) middle[c] += p[k][c] / n;
    if (!(across_m >= 0.1)) return leave(i, CULTURE_LEFT_CROSSED);
    return across_m > 300 ? leave(i, CULTURE_LEFT_LARGE) : add_point(i, middle, across_m);
}

/* ---- features ---------------------------------------------------------------------------------------- */

static Status make_part(Import *i, const VectorPart *part)
{
    CultureFacts  *f = &i->facts;
    const uint32_t ringed = part->shape == VECTOR_POLYGON;
    i->part = part, i->made = 0;
    culture_facts(f, &i->rules, part->tags, part->name, part->value);
    if (f->hidden) return leave(i, CULTURE_LEFT_HIDDEN);
    /* an area of which nothing says what it is: footprints that have heights alone, or nothing at all */
    const CultureRule *rule = rule_of(i);
    if (!rule && (f->known || !ringed)) return leave(i, CULTURE_LEFT_OTHER);
    for (int k = 0; k < part->corners; k++)
        culture_place(i->corner_m[k], i->from, part->lon_lat_rad[k][0], part->lon_lat_rad[k][1]);
    if (!rule || rule->makes == MAKES_BUILDING) return add_building(i);
    if (rule->makes == MAKES_TREE) return add_tree(i, i->corner_m[0], rule);
    if (rule->makes == MAKES_POINT) return ringed ? add_round(i) : add_point(i, i->corner_m[0], NAN);
    if (part->corners == 0) return leave(i, CULTURE_LEFT_LARGE);
    if (ringed) memcpy(i->corner_m[part->corners], i->corner_m[0], sizeof *i->corner_m);
    return add_runs(i, part->corners + (int)ringed, rule->makes == MAKES_TREE_ROW ? add_row : add_line);
}

/* The records made so far, those that are not kept too. */
static void count_made(int64_t out[4], const Import *i)
{
    const Culture *c = i->culture;
    const int      kept[4] = {c->buildings, c->lines, c->points, c->trees};
    for (int k = 0; k < 4; k++) out[k] = i->passed[k] + kept[k];
}

static Status take_part(void *user, const VectorPart *part)
{
    Import      *i = user;
    Culture     *c = i->culture;
    const Status status = make_part(i, part);
    if (!i->from->passes) return status;
    count_made(i->passed, i);
    c->corners = c->buildings = c->lines = c->points = c->trees = 0;
    return status;
}

/* Degrees about the square, with room for its curvature; NaN near a pole or the date line: everything is asked for. */
static void box_of(double deg[4], const CultureFiles *from)
{
    const Geodetic *o = &from->frame->origin;
    const double    lat = o->lat_rad / rad_per_deg, lon = o->lon_rad / rad_per_deg;
    const double    high = 1.5 * from->half_m / 110e3 + 0.001, wide = high / fmax(cos(o->lat_rad), 1e-3);
    const bool      plain = fabs(lat) + high < 85 && fabs(lon) + wide < 180;
    deg[0] = plain ? lon - wide : NAN, deg[1] = lat - high, deg[2] = lon + wide, deg[3] = lat + high;
}

static Status read_vectors(Import *i)
{
    Vectors   vectors = {0};
    VectorEnd end = {0};
    double    box_deg[4];
    Status    status = culture_rules_open(&i->rules, NULL);
    box_of(box_deg, i->from);
    i->corner_m = malloc((vector_most_corners + 1) * sizeof *i->corner_m);
    i->ring_m = malloc(vector_most_corners * sizeof *i->ring_m);
    if (status == STATUS_OK && !(i->corner_m && i->ring_m)) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = vectors_open(&vectors, i->from->buildings, "terrain.buildings");
    if (status == STATUS_OK) status = vectors_each(&end, &vectors, box_deg, take_part, i, "terrain.buildings");
    vectors_close(&vectors);
    culture_rules_close(&i->rules);
    free(i->corner_m), free(i->ring_m), free(i->known.slot);
    i->report->features = end.features;
    i->report->left[CULTURE_LEFT_OUTSIDE] += (int)fmin((double)end.outside, 1e9);
    i->report->left[CULTURE_LEFT_OTHER] += (int)fmin((double)end.shapeless, 1e9);
    return status;
}

/* ---- all of it ---------------------------------------------------------------------------------------- */

void culture_report_left(char *out, size_t out_size, const CultureReport *r)
{
    static const char *const why[CULTURE_LEFTS] = {
        [CULTURE_LEFT_OUTSIDE] = "outside the terrain",
        [CULTURE_LEFT_LARGE] = "larger than 1 km2 or of more than 4096 corners",
        [CULTURE_LEFT_CROSSED] = "with outlines that cross themselves, are smaller than 1 m2 or not on the Earth",
        [CULTURE_LEFT_OTHER] = "of kinds that are not shown",
        [CULTURE_LEFT_HIDDEN] = "in tunnels or underground",
        [CULTURE_LEFT_TWICE] = "that are there already"};
    size_t used = 0;
    *out = 0;
    for (int k = 0; k < CULTURE_LEFTS; k++)
        if (r->left[k] > 0 && used < out_size)
            used += (size_t)snprintf(out + used, out_size - used, "%s%d %s", used ? ", " : "", r->left[k], why[k]);
}

/* One line, a warning where the files have what cannot be true. */
static void say(const Import *i, const CultureReport *r)
{
    const CultureFiles *from = i->from;
    char                left[512];
    int64_t             made[4];
    const bool absurd = r->mended + r->unread + r->left[CULTURE_LEFT_LARGE] + r->left[CULTURE_LEFT_CROSSED] > 0;
    culture_report_left(left, sizeof left, r);
    count_made(made, i);
    if (!*left && !absurd) return;
    (absurd ? log_warn : log_detail)(
        "terrain.buildings: %s: left out %s; numbers left aside: %d that could not be true, %d that are none; `pitviper "
        "terrain culture FILE` lists what there is (%lld buildings, %lld lines, %lld points, %lld trees)",
        from->buildings && *from->buildings ? from->buildings : from->trees, *left ? left : "nothing", r->mended,
        r->unread, (long long)made[0], (long long)made[1], (long long)made[2], (long long)made[3]);
}

Status culture_open(Culture *out, CultureReport *report, const CultureFiles *from)
{
    Culture       culture = {0};
    CultureReport r = {.low_m = INFINITY, .high_m = -INFINITY};
    Import        import = {.from = from, .culture = &culture, .report = &r};
    Status        status = STATUS_OK;
    if (from->buildings && *from->buildings) status = read_vectors(&import);
    if (status == STATUS_OK && from->trees && *from->trees) status = culture_trees_read(&culture, &r, from);
    if (status == STATUS_OK) status = culture_leave_poles(&culture, &r);
    if (status != STATUS_OK) {
        culture_free(&culture);
        return status;
    }
    for (int n = 0; n < culture.trees; n++) r.trees_marked += culture.tree[n].mark != PLANT_UNMARKED;
    for (int k = 0; k < CULTURE_LEFTS; k++) culture.left_out += r.left[k];
    say(&import, &r);
    *out = culture;
    if (report) *report = r;
    return STATUS_OK;
}

bool culture_files_good(const char *buildings, const char *trees)
{
    LocalFrame frame;
    Geodetic   middle = {0};
    Culture    culture = {0};
    if (*buildings && !culture_middle(&middle, buildings)) return false;
    const bool good =
        local_frame_at(&frame, &middle) == STATUS_OK && culture_open(&culture, NULL,
                                                                     &(CultureFiles){.buildings = buildings,
                                                                                     .trees = trees,
                                                                                     .frame = &frame,
                                                                                     .half_m = culture_farthest_m,
                                                                                     .passes = true}) == STATUS_OK;
    culture_free(&culture);
    return good;
}

bool culture_middle(Geodetic *out, const char *files)
{
    Vectors       vectors = {0};
    const Status  status = vectors_open(&vectors, files, "terrain.buildings");
    const double *b = vectors.box_deg;
    const bool    there = status == STATUS_OK && isfinite(b[0] + b[1] + b[2] + b[3]);
    if (there)
        *out = (Geodetic){.lat_rad = 0.5 * (b[1] + b[3]) * rad_per_deg, .lon_rad = 0.5 * (b[0] + b[2]) * rad_per_deg};
    else if (status == STATUS_OK) log_error("terrain.buildings: %s holds nothing that has a place", files);
    vectors_close(&vectors);
    return there;
}
