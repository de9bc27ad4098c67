// Finds the horizon candidates of one azimuth.
