#include "core/scene/sky/sun_position.h"

#include <cstdint>

namespace ulam {
namespace {

/// Of noon, which begins it: the Julian day number of a date of the Gregorian calendar (H. F. Fliegel, T. C. Van Flandern,
/// CACM 11(10), 1968). Divisions round towards zero.
int64_t julianDay(int64_t year, int64_t month, int64_t day) {
    const int64_t early = (month - 14) / 12;  // −1 in January and February
    return (1461 * (year + 4800 + early)) / 4 + (367 * (month - 2 - 12 * early)) / 12 -
           (3 * ((year + 4900 + early) / 100)) / 4 + day - 32075;
}

}  // namespace

SunPosition sunPosition(const PlaceAndTime& when) {
    constexpr double kDegree = kPi / 180, kJ2000 = 2451545;  // noon, 1 January 2000
    const double hours = when.hour - when.timezone + (when.minute + when.second / 60) / 60;
    const double days = double(julianDay(when.year, when.month, when.day)) - 0.5 + hours / 24 - kJ2000;

    // Ecliptic coordinates.
    const double omega = 2.1429 - 0.0010394594 * days;
    const double meanLongitude = 4.8950630 + 0.017202791698 * days;
    const double anomaly = 6.2400600 + 0.0172019699 * days;
    const double longitude = meanLongitude + 0.03341607 * std::sin(anomaly) + 0.00034894 * std::sin(2 * anomaly) -
                             0.0001134 - 0.0000203 * std::sin(omega);
    const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(omega);

    // Celestial coordinates.
    const double rightAscension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
    const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));

    // Horizontal coordinates.
    const double greenwichHours = 6.6974243242 + 0.0657098283 * days + hours;
    const double hourAngle = (greenwichHours * 15 + when.longitude) * kDegree - rightAscension;
    const double latitude = when.latitude * kDegree;
    const double cosZenith = std::cos(latitude) * std::cos(hourAngle) * std::cos(declination) +
                             std::sin(declination) * std::sin(latitude);
    const double zenith = std::acos(std::clamp(cosZenith, -1.0, 1.0));
    const double azimuth =
        std::atan2(-std::sin(hourAngle), std::tan(declination) * std::cos(latitude) - std::sin(latitude) * std::cos(hourAngle));
    constexpr double kParallax = 6371.01 / 149597890;  // the Earth's mean radius over its distance
    return {zenith + kParallax * std::sin(zenith), azimuth < 0 ? azimuth + 2 * kPi : azimuth};
}

}  // namespace ulam
