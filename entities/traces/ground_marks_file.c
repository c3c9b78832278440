/* entities/traces/ground_marks_file.c: ground marks as a CSV file, over a restart. */
#include "entities/traces/ground_marks_private.h"

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

static const double latest_unix_s = 1e12, earth_m = 1e8, largest_m = 1000, hottest_j_m2 = 1e9;
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

/* A row that is being read; its first error is kept, and was logged by table_number. */
typedef struct Row {
    const Table *table;
    const int   *column; /* [column_count] places of the columns in the file */
    int          row;
    double       unix_s;
    Status       status;
} Row;

static Status complain(const Row *r, const char *what)
{
    log_error("marks: %s:%d: %s", r->table->path, r->table->line[r->row + 1], what);
    return STATUS_BAD_VALUE;
}

static double number(Row *r, int at, double low, double high)
{
    double value = low;
    if (r->status == STATUS_OK) r->status = table_number(&value, r->table, r->row, r->column[at], low, high);
    return value;
}

static void numbers(double *out, Row *r, int at, int count, double most)
{
    for (int i = 0; i < count; i++) out[i] = number(r, at + i, -most, most);
}

static void lengths(float *out, Row *r, int at, int count, double low, double high)
{
    for (int i = 0; i < count; i++) out[i] = (float)number(r, at + i, low, high);
}

static double time_of(Row *r, int at) { return number(r, at, -latest_unix_s, latest_unix_s) - r->unix_s; }

static void place(double p_ecef[3], Row *r, int at)
{
    numbers(p_ecef, r, at, 3, earth_m);
    const double r_m = v3_length(p_ecef);
    if (r->status == STATUS_OK && !(r_m >= 1e5 && r_m <= earth_m))
        r->status = complain(r, "a place far from the Earth's surface");
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

static void take_blow(GroundBlow *b, Row *r, double stand_to_s)
{
    const char *to = table_text(r->table, r->row, r->column[at_blow_to]);
    lengths(b->at_m, r, at_blow, 3, -largest_m, largest_m);
    lengths(b->d, r, at_blow_d, 3, -1.001, 1.001);
    lengths(&b->radius_m, r, at_blow_radius, 1, 0, largest_m);
    lengths(&b->speed_mps, r, at_blow_speed, 1, 0, 1000);
    lengths(&b->excess_k, r, at_blow_excess, 1, 0, 5000);
    b->from_s = time_of(r, at_blow_from);
    b->to_s = *to ? fmin(time_of(r, at_blow_to), stand_to_s) : stand_to_s;
}

static void take_stand(GroundHistory *h, Row *r)
{
    GroundStand s = {0};
    const char *to = table_text(r->table, r->row, r->column[at_to]);
    s.owner = (uint64_t)number(r, at_owner, 1, 0x1p49);
    s.from_s = time_of(r, at_from);
    s.to_s = *to ? time_of(r, at_to) : fmax(s.from_s, 0); /* the exercise was paused */
    place(s.p_ecef, r, at_p);
    numbers(s.r_ecef_from_body, r, at_r, 9, 2);
    lengths(s.low_m, r, at_low, 3, -largest_m, largest_m);
    lengths(s.high_m, r, at_high, 3, -largest_m, largest_m);
    if (r->column[at_blow_from] >= 0 && *table_text(r->table, r->row, r->column[at_blow_from]))
        take_blow(&s.blow, r, s.to_s);
    if (r->status != STATUS_OK) return;
    if (!is_rotation(s.r_ecef_from_body)) r->status = complain(r, "r11 to r33 are no rotation");
    else if (!(s.from_s <= s.to_s && (!*to || s.to_s - s.from_s <= longest_s)))
        r->status = complain(r, "to_unix_s is before from_unix_s, or a thousand years later");
    for (int i = 0; i < 3 && r->status == STATUS_OK; i++)
        if (!(s.low_m[i] <= s.high_m[i])) r->status = complain(r, "the box ends before it begins");
    if (r->status == STATUS_OK) ground_stand_open(h, &s);
}

static void take_track(GroundHistory *h, Row *r)
{
    GroundTrack t = {0};
    double      along[3];
    if (*table_text(r->table, r->row, r->column[at_owner])) t.owner = (uint64_t)number(r, at_owner, 1, 0x1p49);
    t.a_s = time_of(r, at_from);
    t.b_s = time_of(r, at_to);
    place(t.a_ecef, r, at_p);
    place(t.b_ecef, r, at_q);
    lengths(&t.width_m, r, at_width, 1, 0, largest_m);
    lengths(&t.apart_m, r, at_apart, 1, 0, largest_m);
    lengths(&t.heat_j_m2, r, at_heat, 1, 0, hottest_j_m2);
    const double tracked = number(r, at_tracked, 0, 1);
    if (r->status != STATUS_OK) return;
    t.tracked = tracked != 0;
    v3_sub(along, t.b_ecef, t.a_ecef);
    if (tracked != 0 && tracked != 1) r->status = complain(r, "tracked is neither 0 nor 1");
    else if (!(t.a_s <= t.b_s)) r->status = complain(r, "to_unix_s is before from_unix_s");
    else if (!(v3_length(along) <= ground_track_longest_m)) r->status = complain(r, "a piece of a track is too long");
    if (r->status != STATUS_OK) return;
    h->track[h->tracks++ % ground_track_capacity] = t;
    h->latest_s = fmax(h->latest_s, t.a_s);
}

static void take_burn(GroundHistory *h, Row *r)
{
    GroundBurn b = {0};
    b.t_s = time_of(r, at_from);
    place(b.p_ecef, r, at_p);
    lengths(&b.radius_m, r, at_radius, 1, 0, largest_m);
    lengths(&b.crater_m, r, at_crater, 1, 0, largest_m);
    lengths(&b.heat_j_m2, r, at_heat, 1, 0, hottest_j_m2);
    if (r->status != STATUS_OK) return;
    h->burn[h->burns++ % ground_burn_capacity] = b;
    h->latest_s = fmax(h->latest_s, b.t_s);
}

static Status take_rows(GroundHistory *h, const Table *table, const int column[column_count], double unix_s)
{
    Row r = {.table = table, .column = column, .unix_s = unix_s};
    for (; r.row < table->rows && r.status == STATUS_OK; r.row++) {
        const char *kind = table_text(table, r.row, column[at_kind]);
        if (strcmp(kind, "stand") == 0) take_stand(h, &r);
        else if (strcmp(kind, "track") == 0) take_track(h, &r);
        else if (strcmp(kind, "burn") == 0) take_burn(h, &r);
        else r.status = complain(&r, "kind is not stand, track or burn");
        if (r.status == STATUS_OK &&
            (h->stands > ground_stand_capacity || h->tracks > ground_track_capacity || h->burns > ground_burn_capacity))
            r.status = complain(&r, "more marks than the program keeps");
    }
    return r.status;
}

/* Finds the columns. A file may have none for exhaust: those are -1 then. */
static bool find_columns(int column[column_count], const Table *table)
{
    bool blows = false;
    for (int c = at_blow; c < column_count; c++) {
        column[c] = table_column(table, column_name[c]);
        blows |= column[c] >= 0;
    }
    return table_columns(column, table, column_name, blows ? column_count : at_blow, "marks");
}

Status ground_marks_load(GroundHistory *h, double unix_s, const char *path)
{
    Table          table = {0};
    GroundHistory *loaded = NULL;
    int            column[column_count];
    if (!isfinite(unix_s)) return STATUS_BAD_VALUE;
    if (h->stands || h->tracks || h->burns) {
        log_error("marks: %s can be loaded before the exercise only", path);
        return STATUS_UNSUPPORTED;
    }
    Status status = table_open(&table, path);
    if (status == STATUS_OK && !find_columns(column, &table)) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = ground_history_create(&loaded);
    if (status == STATUS_OK) status = take_rows(loaded, &table, column, unix_s);
    if (status == STATUS_OK) *h = *loaded;
    ground_history_destroy(loaded);
    table_close(&table);
    return status;
}
