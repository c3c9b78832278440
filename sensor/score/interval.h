/* sensor/score/interval.h: intervals of 95 % of rates over sequences.
 *
 * Frames of a sequence are of one orbit and look alike: a target that is missed in one is missed in the next. So a
 * sequence is one sample, however many frames it has, and a hundred frames of one orbit say as much as one. The
 * interval is nominal where all frames of a sequence agree, and wider than need be where they do not
 * (tests/sensor/test_score_interval.c counts how often it holds the truth). */
#ifndef SENSOR_SCORE_INTERVAL_H
#define SENSOR_SCORE_INTERVAL_H

#include "pitviper.h"

typedef struct Interval {
    double low, high;
} Interval;

/* Effective number of samples of a mean that gives sample i the weight w_i: (sum w)^2 / sum w^2 (Kish, Survey Sampling,
 * 1965). 0 without any. */
double interval_samples(double sum_w, double sum_w2);

/* Of a share of 0 .. 1 that was found over so many samples, which need not be whole. Source: Wilson, Probable
 * inference, the law of succession, and statistical inference, J. Am. Stat. Assoc. 22 (1927) 209. NaN: no samples. */
Interval interval_of_share(double share, double samples);

/* Of a mean count, such as false alarms a frame: the score interval of a Poisson mean, whose variance is `dispersion`
 * times the mean (1: Poisson). NaN: no samples. */
Interval interval_of_count(double mean, double samples, double dispersion);

/* The dispersion of counts x_i over weights w_i (frames): the variance between samples of x_i / w_i over their mean, 1
 * where it is less or where fewer than two samples tell. sum_x2_w: of x_i^2 / w_i. */
double interval_dispersion(double sum_x, double sum_x2_w, double sum_w, double sum_w2);

#endif
