# Random-walk Metropolis of the R package mcmc on one pack: Rscript mcmc.R CASE_FOLDER REPLICATES EVALUATIONS
library(mcmc)

argument <- commandArgs(trailingOnly = TRUE)
pack <- read.csv(file.path(argument[1], "pack.csv"))
prior <- read.csv(file.path(argument[1], "parameters.csv"))
replicates <- as.integer(argument[2])
evaluations <- as.integer(argument[3])

log_x <- log(pack$x)
v <- pack$v
f <- pack$f
weight <- 1 / pack$noise_sd
prior_mean <- prior$mean
prior_sd <- prior$sd
lower <- prior$lower
upper <- prior$upper

log_posterior <- function(theta) {
  if (any(theta < lower) || any(theta > upper)) return(-Inf)
  residual <- (f - (theta[1] + theta[2] * v) * exp(theta[3] * log_x)) * weight
  z <- (theta - prior_mean) / prior_sd
  -0.5 * (sum(residual * residual) + sum(z * z))
}

# Mode and inverse Gauss-Newton Hessian, by Levenberg-Marquardt from the mean of the prior.
fit <- function() {
  theta <- prior_mean
  damping <- 1e-3
  value <- log_posterior(theta)
  for (round in 1:60) {
    h <- exp(theta[3] * log_x)
    force <- (theta[1] + theta[2] * v) * h
    jacobian <- cbind(h, h * v, force * log_x) * weight
    hessian <- crossprod(jacobian) + diag(1 / prior_sd^2)
    gradient <- crossprod(jacobian, (f - force) * weight) + (prior_mean - theta) / prior_sd^2
    step <- drop(solve(hessian + damping * diag(diag(hessian)), gradient))
    there <- log_posterior(theta + step)
    if (there < value) {
      damping <- 10 * damping
      next
    }
    done <- there - value < 1e-10
    theta <- theta + step
    value <- there
    damping <- 0.1 * damping
    if (done) break
  }
  list(mean = theta, covariance = solve(hessian))
}

# The first fifth tunes, in two runs: metrop times itself and collects garbage for that, some 40 ms a call.
run <- function() {
  laplace <- fit()
  scale <- 2.38 / sqrt(3)
  factor <- t(chol(laplace$covariance))
  start <- laplace$mean
  tuning <- evaluations %/% 10
  for (round in 1:2) {
    pilot <- metrop(log_posterior, start, nbatch = tuning, scale = scale * factor)
    start <- pilot$final
    scale <- scale * exp(2 * (pilot$accept - 0.3))
    if (round == 2 && pilot$accept > 0.05) factor <- t(chol(cov(pilot$batch)))
  }
  kept <- evaluations - 2 * tuning
  walk <- metrop(log_posterior, start, nbatch = kept, scale = scale * factor)
  c(walk$accept, colMeans(walk$batch))
}

cat("# peer: R ", as.character(getRversion()), ", mcmc ", as.character(packageVersion("mcmc")), " metrop\n", sep = "")
cat("# how: starts at a least squares fit, steps with its covariance and then with that of the draws; scale tuned to an",
    "acceptance of 30 %; the first fifth is used for tuning and discarded\n")
cat("ms,acceptance,evaluations,K,B,p\n")
for (replicate in seq_len(replicates)) {
  set.seed(1000 + replicate)
  began <- Sys.time()
  got <- run()
  ms <- 1e3 * as.numeric(Sys.time() - began, units = "secs")
  cat(sprintf("%.6g,%.4g,%d,%.17g,%.17g,%.17g\n", ms, got[1], evaluations, got[2], got[3], got[4]))
}
