/* dis/delay_line.h: the least delay of a sender's datagrams over its own time: lower convex hull of (stamp, arrival -
 * stamp), after Moon, Skelly and Towsley, Estimation and removal of clock skew from network delay measurements, INFOCOM
 * 1999.
 *
 * Queues only ever delay, so the clocks' difference is the lower edge of the points; what lies above it is jitter. After N
 * datagrams with uniform jitter J the edge is J / N too high in the mean, and more than 3 J / N once in 20 times: so is
 * the least of N such delays, and nothing else is known (tests/sensor/test_time_stamps.c). Its slope, the clocks' drift, is taken only where it exceeds
 * what jitter makes of one. A change below 0.1 ms is not applied: so exact recordings keep the offset of their first PDU to
 * the bit. Depends on the order of the calls only. */
#ifndef DIS_DELAY_LINE_H
#define DIS_DELAY_LINE_H

#include "pitviper.h"

enum { delay_line_vertices = 16 };

typedef struct DelayLine {
    int      count;                  /* vertices of the hull, by x */
    double   x_s[delay_line_vertices + 1], y_s[delay_line_vertices + 1];
    uint64_t points;
    double   mean_x_s, mean_y_s;
    double   offset_s, slope, at_s;  /* applied: offset_s + slope (x - at_s) */
} DelayLine;

/* x_s: the sender's time; y_s: arrival less that. */
void delay_line_begin(DelayLine *line, double x_s, double y_s);
void delay_line_add(DelayLine *line, double x_s, double y_s);
static inline double delay_line_at(const DelayLine *line, double x_s)
{
    return line->offset_s + line->slope * (x_s - line->at_s);
}
/* Slope of the hull's edge below the middle of the points, and the time from its first vertex to its last. */
double delay_line_edge(double *span_s, double *middle_s, const DelayLine *line);

/* ---- trend ------------------------------------------------------------------------------------ */

/* The straight line through the points by least squares: finds a clock at another rate from its first few PDUs. */
typedef struct DelayTrend {
    uint64_t points;
    double   first_x_s, last_x_s;
    double   latest_x_s, latest_y_s; /* of the latest added */
    double   mean_x_s, mean_y_s, xx, xy, yy;
} DelayTrend;

/* PDUs of one datagram with one stamp are one point. */
void delay_trend_add(DelayTrend *trend, double x_s, double y_s);
/* Slope and its standard error; false: fewer than three points, or all of one stamp. */
bool delay_trend_slope(double *slope, double *error, const DelayTrend *trend);
double delay_trend_scatter(const DelayTrend *trend); /* standard deviation about the line, s */
/* By how much larger than its standard error the slope of that many points must be: chance makes one in ten thousand. */
double delay_trend_critical(uint64_t points);

#endif
