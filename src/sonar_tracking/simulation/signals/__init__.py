"""Waveforms, propagation and snapshots of sources."""
