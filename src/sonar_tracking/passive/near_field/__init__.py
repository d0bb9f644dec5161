"""Sources so near that their wavefronts are curved: bearing and range from one covariance."""
