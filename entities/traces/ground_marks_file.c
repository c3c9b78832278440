/* entities/traces/ground_marks_file.c: ground marks as a CSV file, over a restart. */
#include "entities/traces/ground_marks_private.h"

#include "pitviper_table.h"

#include <stdlib.h>

/* Columns of the file; those from `from_unix_s` on are numbers. A cell is empty where the kind of mark has no such
 * figure. */
enum {
    at_kind,
    at_owner,
    at_from,
    at_to,
    at_p,
    at_q = at_p + 3,
    at_r = at_q + 3,
    at_low = at_r + 9,
    at_high = at_low + 3,
    at_width = at_high + 3,
    at_apart,
    at_tracked,
    at_radius,
    at_crater,
    at_heat,
    at_blow,
    at_blow_d = at_blow + 3,
    at_blow_radius = at_blow_d + 3,
    at_blow_speed,
    at_blow_excess,
    at_blow_from,
    at_blow_to,
    column_count
};
static const char *const column_name[column_count] = {"kind",
                                                      "owner",
                                                      "from_unix_s",
                                                      "to_unix_s",
                                                      "x_m",
                                                      "y_m",
                                                      "z_m",
                                                      "to_x_m",
                                                      "to_y_m",
                                                      "to_z_m",
                                                      "r11",
                                                      "r12",
                                                      "r13",
                                                      "r21",
                                                      "r22",
                                                      "r23",
                                                      "r31",
                                                      "r32",
                                                      "r33",
                                                      "low_x_m",
                                                      "low_y_m",
                                                      "low_z_m",
                                                      "high_x_m",
                                                      "high_y_m",
                                                      "high_z_m",
                                                      "width_m",
                                                      "apart_m",
                                                      "tracked",
                                                      "radius_m",
                                                      "crater_m",
                                                      "heat_j_m2",
                                                      "outlet_x_m",
                                                      "outlet_y_m",
                                                      "outlet_z_m",
                                                      "blow_x",
                                                      "blow_y",
                                                      "blow_z",
                                                      "blow_radius_m",
                                                      "blow_mps",
                                                      "blow_excess_k",
                                                      "blow_from_unix_s",
                                                      "blow_to_unix_s"};

static const double longest_s = 3.2e10; /* longest stand, a thousand years */

/* ---- saved ---------------------------------------------------------------------------------- */

/* A number in the column `at`; *column: the one to be written next. */
static void put(FILE *to, int *column, int at, double value, int digits)
{
    for (; *column < at; ++*column) fputc(',', to);
    fprintf(to, "%.*g", digits, value);
}

static void put_places(FILE *to, int *column, int at, const double *value, int count)
{
    for (int i = 0; i < count; i++) put(to, column, at + i, value[i], 17);
}

static void put_lengths(FILE *to, int *column, int at, const float *value, int count)
{
    for (int i = 0; i < count; i++) put(to, column, at + i, (double)value[i], 9);
}

static void end_row(FILE *to, int column)
{
    for (; column < column_count - 1; column++) fputc(',', to);
    fputc('\n', to);
}

static void put_blow(FILE *to, int *column, const GroundBlow *b, double unix_s)
{
    put_lengths(to, column, at_blow, b->at_m, 3);
    put_lengths(to, column, at_blow_d, b->d, 3);
    put_lengths(to, column, at_blow_radius, &b->radius_m, 1);
    put_lengths(to, column, at_blow_speed, &b->speed_mps, 1);
    put_lengths(to, column, at_blow_excess, &b->excess_k, 1);
    put(to, column, at_blow_from, unix_s + b->from_s, 17);
    if (isfinite(b->to_s)) put(to, column, at_blow_to, unix_s + b->to_s, 17);
}

static void put_stand(FILE *to, const GroundStand *s, double unix_s)
{
    int column = at_owner;
    fprintf(to, "stand,%llu", (unsigned long long)s->owner);
    put(to, &column, at_from, unix_s + s->from_s, 17);
    if (isfinite(s->to_s)) put(to, &column, at_to, unix_s + s->to_s, 17);
    put_places(to, &column, at_p, s->p_ecef, 3);
    put_places(to, &column, at_r, s->r_ecef_from_body, 9);
    put_lengths(to, &column, at_low, s->low_m, 3);
    put_lengths(to, &column, at_high, s->high_m, 3);
    if (s->blow.to_s > s->blow.from_s) put_blow(to, &column, &s->blow, unix_s);
    end_row(to, column);
}

static void put_track(FILE *to, const GroundTrack *t, double unix_s)
{
    int column = at_owner;
    fprintf(to, "track,");
    if (t->owner) fprintf(to, "%llu", (unsigned long long)t->owner);
    put(to, &column, at_from, unix_s + t->a_s, 17);
    put(to, &column, at_to, unix_s + t->b_s, 17);
    put_places(to, &column, at_p, t->a_ecef, 3);
    put_places(to, &column, at_q, t->b_ecef, 3);
    put_lengths(to, &column, at_width, &t->width_m, 1);
    put_lengths(to, &column, at_apart, &t->apart_m, 1);
    put(to, &column, at_tracked, t->tracked, 1);
    put_lengths(to, &column, at_heat, &t->heat_j_m2, 1);
    end_row(to, column);
}

static void put_burn(FILE *to, const GroundBurn *b, double unix_s)
{
    int column = at_kind;
    fprintf(to, "burn");
    put(to, &column, at_from, unix_s + b->t_s, 17);
    put_places(to, &column, at_p, b->p_ecef, 3);
    put_lengths(to, &column, at_radius, &b->radius_m, 1);
    put_lengths(to, &column, at_crater, &b->crater_m, 1);
    put_lengths(to, &column, at_heat, &b->heat_j_m2, 1);
    end_row(to, column);
}

typedef struct Saved {
    const GroundHistory *history;
    double               unix_s;
} Saved;

static void put_all(FILE *to, const void *user)
{
    const GroundHistory *h = ((const Saved *)user)->history;
    const double         unix_s = ((const Saved *)user)->unix_s;
    fputs(
        "# Ground marks of Pitviper: where entities stood, tracks of vehicles, burnt ground. Times: Unix time, s; an "
        "empty to_unix_s:\n# without a known end. Places: WGS 84 geocentric, m. Written and read again by the program.\n",
        to);
    for (int c = 0; c < column_count; c++) fprintf(to, "%s%c", column_name[c], c < column_count - 1 ? ',' : '\n');
    const int stands = ring_count(h->stands, ground_stand_capacity),
              stand = ring_first(h->stands, ground_stand_capacity);
    const int tracks = ring_count(h->tracks, ground_track_capacity),
              track = ring_first(h->tracks, ground_track_capacity);
    const int burns = ring_count(h->burns, ground_burn_capacity), burn = ring_first(h->burns, ground_burn_capacity);
    for (int i = 0; i < stands; i++) put_stand(to, &h->stand[(stand + i) % ground_stand_capacity], unix_s);
    for (int i = 0; i < tracks; i++) put_track(to, &h->track[(track + i) % ground_track_capacity], unix_s);
    for (int i = 0; i < burns; i++) put_burn(to, &h->burn[(burn + i) % ground_burn_capacity], unix_s);
}

Status ground_marks_save(const GroundHistory *h, double unix_s, const char *path)
{
    return isfinite(unix_s) ? text_write_file("marks", path, put_all, &(Saved){h, unix_s}) : STATUS_BAD_VALUE;
}

/* ---- loaded --------------------------------------------------------------------------------- */

/* A row as it is in the file: of each kind of mark a part. */
typedef struct Row {
    int    kind;
    double owner, from_unix_s, to_unix_s; /* owner 0: none; to_unix_s NaN: no end is known */
    double p[3], q[3], r[9];
    float  low[3], high[3], width_m, apart_m, radius_m, crater_m, heat_j_m2;
    double tracked;
    float  blow[3], blow_d[3], blow_radius_m, blow_mps, blow_excess_k;
    double blow_from_unix_s, blow_to_unix_s;
} Row;

/* Columns of the file from `at` on, whose members are beside one another. */
typedef struct Part {
    int         at, count;
    TableType   type;
    size_t      offset;
    double      low, high;
    TableAbsent absent;
} Part;

#define PLACE(at, member)                                                                                              \
    {                                                                                                                  \
        at, 3, TABLE_DOUBLE, offsetof(Row, member), -1e8, 1e8, TABLE_REQUIRED                                          \
    }
#define LENGTH(at, count, member, low, high)                                                                           \
    {                                                                                                                  \
        at, count, TABLE_FLOAT, offsetof(Row, member), low, high, TABLE_REQUIRED                                       \
    }
#define TIME(at, member, absent)                                                                                       \
    {                                                                                                                  \
        at, 1, TABLE_DOUBLE, offsetof(Row, member), -1e12, 1e12, absent                                                \
    }

enum { KIND_STAND, KIND_TRACK, KIND_BURN, KIND_BLOW, kinds, parts_most = 10 };

static const Part parts[kinds][parts_most] = {
    [KIND_STAND] = {{at_owner, 1, TABLE_DOUBLE, offsetof(Row, owner), 1, 0x1p49, TABLE_REQUIRED},
                    TIME(at_from, from_unix_s, TABLE_REQUIRED),
                    TIME(at_to, to_unix_s, TABLE_EMPTY),
                    PLACE(at_p, p),
                    {at_r, 9, TABLE_DOUBLE, offsetof(Row, r), -2, 2, TABLE_REQUIRED},
                    LENGTH(at_low, 3, low, -1000, 1000),
                    LENGTH(at_high, 3, high, -1000, 1000)},
    [KIND_TRACK] = {{at_owner, 1, TABLE_DOUBLE, offsetof(Row, owner), 1, 0x1p49, TABLE_EMPTY},
                    TIME(at_from, from_unix_s, TABLE_REQUIRED),
                    TIME(at_to, to_unix_s, TABLE_REQUIRED),
                    PLACE(at_p, p),
                    PLACE(at_q, q),
                    LENGTH(at_width, 1, width_m, 0, 1000),
                    LENGTH(at_apart, 1, apart_m, 0, 1000),
                    LENGTH(at_heat, 1, heat_j_m2, 0, 1e9),
                    {at_tracked, 1, TABLE_WHOLE, offsetof(Row, tracked), 0, 1, TABLE_REQUIRED}},
    [KIND_BURN] = {TIME(at_from, from_unix_s, TABLE_REQUIRED), PLACE(at_p, p), LENGTH(at_radius, 1, radius_m, 0, 1000),
                   LENGTH(at_crater, 1, crater_m, 0, 1000), LENGTH(at_heat, 1, heat_j_m2, 0, 1e9)},
    [KIND_BLOW] = {LENGTH(at_blow, 3, blow, -1000, 1000), LENGTH(at_blow_d, 3, blow_d, -1.001, 1.001),
                   LENGTH(at_blow_radius, 1, blow_radius_m, 0, 1000), LENGTH(at_blow_speed, 1, blow_mps, 0, 1000),
                   LENGTH(at_blow_excess, 1, blow_excess_k, 0, 5000),
                   TIME(at_blow_from, blow_from_unix_s, TABLE_REQUIRED),
                   TIME(at_blow_to, blow_to_unix_s, TABLE_EMPTY)}};

/* A file's rows as those of each kind; all share one table. A file may have no columns of exhaust. */
typedef struct Reading {
    TableColumn    column[kinds][column_count];
    TableFormat    format[kinds];
    TableRows      of[kinds];
    bool           blows;
    GroundHistory *to;
    double         unix_s;
} Reading;

static void fill_format(TableFormat *out, TableColumn *column, const Part *part)
{
    *out = (TableFormat){.module = "marks", .column = column, .next = "the program writes such files itself"};
    for (int k = 0; k < parts_most && part[k].count > 0; k++)
        for (int i = 0; i < part[k].count; i++) {
            const size_t size = part[k].type == TABLE_FLOAT ? sizeof(float) : sizeof(double);
            column[out->count++] = (TableColumn){.name = column_name[part[k].at + i],
                                                 .type = part[k].type,
                                                 .offset = part[k].offset + (size_t)i * size,
                                                 .low = part[k].low,
                                                 .high = part[k].high,
                                                 .absent = part[k].absent,
                                                 .otherwise = part[k].at == at_owner ? 0 : NAN};
        }
}

static bool is_rotation(const double m[9])
{
    double across[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
            if (!(fabs(v3_dot(m + 3 * i, m + 3 * j) - (i == j)) <= 1e-6)) return false;
    v3_cross(across, m, m + 3);
    return v3_dot(across, m + 6) > 0;
}

static bool near_earth(const double p_ecef[3])
{
    const double r_m = v3_length(p_ecef);
    return r_m >= 1e5 && r_m <= 1e8;
}

/* What is wrong with the mark; NULL: it was taken. */
static const char *take_stand(const Reading *g, const Row *r)
{
    const bool  ends = !isnan(r->to_unix_s);
    GroundStand s = {.owner = (uint64_t)r->owner, .from_s = r->from_unix_s - g->unix_s};
    s.to_s = ends ? r->to_unix_s - g->unix_s : fmax(s.from_s, 0); /* the exercise was paused */
    memcpy(s.p_ecef, r->p, sizeof s.p_ecef);
    memcpy(s.r_ecef_from_body, r->r, sizeof s.r_ecef_from_body);
    memcpy(s.low_m, r->low, sizeof s.low_m);
    memcpy(s.high_m, r->high, sizeof s.high_m);
    if (r->blow_radius_m >= 0) {
        GroundBlow *b = &s.blow;
        memcpy(b->at_m, r->blow, sizeof b->at_m);
        memcpy(b->d, r->blow_d, sizeof b->d);
        b->radius_m = r->blow_radius_m, b->speed_mps = r->blow_mps, b->excess_k = r->blow_excess_k;
        b->from_s = r->blow_from_unix_s - g->unix_s;
        b->to_s = isnan(r->blow_to_unix_s) ? s.to_s : fmin(r->blow_to_unix_s - g->unix_s, s.to_s);
    }
    if (!is_rotation(s.r_ecef_from_body)) return "r11 to r33 are no rotation";
    if (!(s.from_s <= s.to_s && (!ends || s.to_s - s.from_s <= longest_s)))
        return "to_unix_s is before from_unix_s, or a thousand years later";
    for (int i = 0; i < 3; i++)
        if (!(s.low_m[i] <= s.high_m[i])) return "the box ends before it begins";
    ground_stand_open(g->to, &s);
    return NULL;
}

static const char *take_track(const Reading *g, const Row *r)
{
    GroundHistory *h = g->to;
    GroundTrack    t = {.owner = (uint64_t)r->owner,
                        .a_s = r->from_unix_s - g->unix_s,
                        .b_s = r->to_unix_s - g->unix_s,
                        .width_m = r->width_m,
                        .apart_m = r->apart_m,
                        .heat_j_m2 = r->heat_j_m2,
                        .tracked = r->tracked != 0};
    double         along[3];
    memcpy(t.a_ecef, r->p, sizeof t.a_ecef);
    memcpy(t.b_ecef, r->q, sizeof t.b_ecef);
    v3_sub(along, t.b_ecef, t.a_ecef);
    if (!near_earth(r->q)) return "a place far from the Earth's surface";
    if (!(t.a_s <= t.b_s)) return "to_unix_s is before from_unix_s";
    if (!(v3_length(along) <= ground_track_longest_m)) return "a piece of a track is too long";
    h->track[h->tracks++ % ground_track_capacity] = t;
    h->latest_s = fmax(h->latest_s, t.a_s);
    return NULL;
}

static const char *take_burn(const Reading *g, const Row *r)
{
    GroundHistory *h = g->to;
    GroundBurn     b = {
            .t_s = r->from_unix_s - g->unix_s, .radius_m = r->radius_m, .crater_m = r->crater_m, .heat_j_m2 = r->heat_j_m2};
    memcpy(b.p_ecef, r->p, sizeof b.p_ecef);
    h->burn[h->burns++ % ground_burn_capacity] = b;
    h->latest_s = fmax(h->latest_s, b.t_s);
    return NULL;
}

static Status take_row(Reading *g, const TableRows *rows, int number)
{
    Row                  row = {.blow_radius_m = -1};
    const GroundHistory *h = g->to;
    Status               status = table_rows_get(&row, rows, number);
    if (status == STATUS_OK) status = table_rows_get(&row, &g->of[row.kind], number);
    if (status == STATUS_OK && row.kind == KIND_STAND && g->blows && *table_rows_text(rows, number, "blow_from_unix_s"))
        status = table_rows_get(&row, &g->of[KIND_BLOW], number);
    if (status != STATUS_OK) return status;
    const char *wrong = !near_earth(row.p)       ? "a place far from the Earth's surface"
                        : row.kind == KIND_STAND ? take_stand(g, &row)
                        : row.kind == KIND_TRACK ? take_track(g, &row)
                                                 : take_burn(g, &row);
    if (!wrong &&
        (h->stands > ground_stand_capacity || h->tracks > ground_track_capacity || h->burns > ground_burn_capacity))
        wrong = "more marks than the program keeps";
    return wrong ? table_rows_refuse(rows, number, NULL, "%s", wrong) : STATUS_OK;
}

static Status take_rows(Reading *g, const char *path)
{
    static const TableColumn kind = {"kind", TABLE_CHOICE, TABLE_AT(Row, kind), .choices = "stand, track, burn"};
    static const TableFormat format = {"marks", &kind, 1, .next = "the program writes such files itself"};
    TableRows                rows;
    Status                   status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    for (int c = at_blow; c < column_count; c++) g->blows |= table_rows_has(&rows, column_name[c]);
    for (int k = 0; k < (g->blows ? kinds : KIND_BLOW) && status == STATUS_OK; k++) {
        fill_format(&g->format[k], g->column[k], parts[k]);
        g->of[k].table = rows.table;
        status = table_rows_use(&g->of[k], &g->format[k]);
    }
    for (int r = 0; r < rows.table.rows && status == STATUS_OK; r++) status = take_row(g, &rows, r);
    table_rows_close(&rows);
    return status;
}

Status ground_marks_load(GroundHistory *h, double unix_s, const char *path)
{
    if (!isfinite(unix_s)) return STATUS_BAD_VALUE;
    if (h->stands || h->tracks || h->burns) {
        log_error("marks: %s can be loaded before the exercise only", path);
        return STATUS_UNSUPPORTED;
    }
    Reading g = {.unix_s = unix_s};
    Status  status = ground_history_create(&g.to);
    if (status == STATUS_OK) status = take_rows(&g, path);
    if (status == STATUS_OK) *h = *g.to;
    ground_history_destroy(g.to);
    return status;
}
