/* pitviper_response.c: reads a spectral response and lays out the nodes of its integrals. */
#include "pitviper_response.h"
#include "pitviper_table.h"

#include <math.h>
#include <stdlib.h>

typedef struct Row {
    double at_m, value;
} Row;

static const TableColumn columns[] = {
    {"wavelength_um", TABLE_DOUBLE, TABLE_AT(Row, at_m), .low = 0.3, .high = 30, .unit = 1e-6},
    {"response", TABLE_DOUBLE, TABLE_AT(Row, value), .low = 0, .high = 1},
};
static const TableFormat format = {"channels",
                                   columns,
                                   2,
                                   .next = "etc/ADDING.md, A channel, explains it",
                                   .least_rows = 2,
                                   .most_rows = response_points_most};

static Status take_point(void *user, const void *read, const TableRows *rows, int row)
{
    SpectralResponse *r = user;
    const Row        *point = read;
    if (r->points > 0 && !(point->at_m > r->at_m[r->points - 1]))
        return table_rows_refuse(rows, row, "wavelength_um", "above that of the row before");
    r->at_m[r->points] = point->at_m;
    r->value[r->points++] = point->value;
    return STATUS_OK;
}

/* Nodes of a piece between two points, on which the response is a straight line. */
static void add_piece(SpectralResponse *r, double from_m, double to_m, int point)
{
    /* Abramowitz & Stegun, table 25.4: n = 2 and n = 4 */
    static const double two[2][2] = {{-0.577350269189625764509, 1}, {0.577350269189625764509, 1}};
    static const double four[4][2] = {{-0.861136311594052575224, 0.347854845137453857373},
                                      {-0.339981043584856264803, 0.652145154862546142627},
                                      {0.339981043584856264803, 0.652145154862546142627},
                                      {0.861136311594052575224, 0.347854845137453857373}};
    const bool          fine = to_m - from_m <= 0.005 * from_m;
    const double(*rule)[2] = fine ? two : four;
    const double low_m = r->at_m[point], span_m = r->at_m[point + 1] - low_m, half_m = 0.5 * (to_m - from_m);
    for (int i = 0; i < (fine ? 2 : 4); i++) {
        const double at_m = from_m + half_m * (1 + rule[i][0]), t = (at_m - low_m) / span_m;
        const double value = r->value[point] + t * (r->value[point + 1] - r->value[point]);
        if (!(value > 0)) continue;
        r->node_m[r->nodes] = at_m;
        r->weight_m[r->nodes++] = half_m * rule[i][1] * value;
    }
}

static void lay_nodes(SpectralResponse *r)
{
    /* pieces: at most one more an interval than ln(30 / 0.3) / ln(1.05) = 94.4 in all, so 606 of four nodes */
    for (int k = 0; k + 1 < r->points; k++) {
        const double ln_ratio = log(r->at_m[k + 1] / r->at_m[k]);
        const int    pieces = (int)fmax(ceil(ln_ratio / log(1.05)), 1);
        for (int i = 0; i < pieces; i++)
            add_piece(r, r->at_m[k] * exp(ln_ratio * i / pieces), r->at_m[k] * exp(ln_ratio * (i + 1) / pieces), k);
    }
}

Status response_open(SpectralResponse **out, const char *path)
{
    Row               row;
    SpectralResponse *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    Status status = table_each(&format, path, &row, sizeof row, take_point, r);
    double most = 0;
    for (int i = 0; i < r->points; i++) most = fmax(most, r->value[i]);
    if (status == STATUS_OK && fabs(most - 1) > 1e-3) {
        log_error("channels: %s: the greatest response is %g, and must be 1 (what the optics and the detector take is "
                  "transmission and qe of the sensor); etc/ADDING.md, A channel, explains it",
                  path, most);
        status = STATUS_BAD_VALUE;
    }
    if (status != STATUS_OK) {
        free(r);
        return status;
    }
    lay_nodes(r);
    *out = r;
    return STATUS_OK;
}

void response_close(SpectralResponse *response) { free(response); }
