"""Sentences of NMEA 0183: own ship from its navigation receivers, other ships from their AIS."""
