#pragma once
// Where the sun stands.
//
// M. Blanco-Muriel, D. C. Alarcón-Padilla, T. López-Moratalla, M. Lara-Coira: "Computing the solar vector", Solar Energy
// 70(5), 2001: within 0.01° from 1999 to 2015, and not much worse some decades around them. Refraction is left out.

#include "core/base/vector.h"

namespace ulam {

struct PlaceAndTime {
    double latitude = 35.6894, longitude = 139.6917;  ///< in degrees, north and east positive
    double timezone = 9;                              ///< hours ahead of Greenwich
    int year = 2010, month = 7, day = 10;             ///< Gregorian
    double hour = 15, minute = 0, second = 0;         ///< of local time, without daylight saving
};

struct SunPosition {
    double zenith;   ///< angle from it, in radians
    double azimuth;  ///< from north towards east, in radians
};

SunPosition sunPosition(const PlaceAndTime& when);

}  // namespace ulam
