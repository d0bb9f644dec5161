"""How many sources and where: MDL on one covariance or several, MUSIC."""
