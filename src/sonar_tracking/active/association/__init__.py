"""Which contact is whose, for all tracks at once: LM-IPDA, HPDA, JPDA."""
