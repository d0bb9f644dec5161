"""Study doa-coherent: Hwang et al. (2005)."""
