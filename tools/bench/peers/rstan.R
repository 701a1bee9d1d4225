# Stan's NUTS on one pack, by rstan: Rscript rstan.R CASE_FOLDER REPLICATES EVALUATIONS
# The model is compiled before the clock runs. Evaluations are those of the gradient, which is dearer than the likelihood.
suppressMessages(library(rstan))
# Debian keeps the headers of Boost and Eigen outside of R.
if (dir.exists("/usr/include/boost")) rstan_options(boost_lib = "/usr/include")

argument <- commandArgs(trailingOnly = TRUE)
pack <- read.csv(file.path(argument[1], "pack.csv"))
prior <- read.csv(file.path(argument[1], "parameters.csv"))
replicates <- as.integer(argument[2])
evaluations <- as.integer(argument[3])

code <- "
data {
  int<lower=1> n;
  vector[n] log_x;
  vector[n] v;
  vector[n] f;
  vector[n] noise_sd;
  vector[3] prior_mean;
  vector[3] prior_sd;
  vector[3] low;
  vector[3] high;
}
parameters {
  real<lower=low[1], upper=high[1]> K;
  real<lower=low[2], upper=high[2]> B;
  real<lower=low[3], upper=high[3]> p;
}
model {
  K ~ normal(prior_mean[1], prior_sd[1]);
  B ~ normal(prior_mean[2], prior_sd[2]);
  p ~ normal(prior_mean[3], prior_sd[3]);
  f ~ normal((K + B * v) .* exp(p * log_x), noise_sd);
}
"
model <- stan_model(model_code = code)
data <- list(n = nrow(pack), log_x = log(pack$x), v = pack$v, f = pack$f, noise_sd = pack$noise_sd,
             prior_mean = prior$mean, prior_sd = prior$sd, low = prior$lower, high = prior$upper)

fit <- function() optimizing(model, data, init = list(K = prior$mean[1], B = prior$mean[2], p = prior$mean[3]))$par

# A third of the draws adapts. How many fit into the evaluations is found once, before the clock runs.
run <- function(draws, seed) {
  chain <- sampling(model, data, chains = 1, iter = draws, warmup = draws %/% 3, seed = seed, refresh = 0,
                    init = list(as.list(fit())))
  used <- get_sampler_params(chain, inc_warmup = TRUE)[[1]]
  kept <- get_sampler_params(chain, inc_warmup = FALSE)[[1]]
  c(mean(kept[, "accept_stat__"]), sum(used[, "n_leapfrog__"]), colMeans(as.matrix(chain, pars = c("K", "B", "p"))))
}

draws <- 600
draws <- max(150, round(draws * evaluations / suppressWarnings(run(draws, 1))[2]))
cat("# peer: R ", as.character(getRversion()), ", rstan ", as.character(packageVersion("rstan")), " NUTS\n", sep = "")
cat("# how: starts at its own optimum; a third of the draws adapts and is thrown away; compiled beforehand; evaluations",
    "are those of the gradient\n")
cat("ms,acceptance,evaluations,K,B,p\n")
for (replicate in seq_len(replicates)) {
  began <- Sys.time()
  got <- suppressWarnings(run(draws, 1000 + replicate))
  ms <- 1e3 * as.numeric(Sys.time() - began, units = "secs")
  cat(sprintf("%.6g,%.4g,%d,%.17g,%.17g,%.17g\n", ms, got[1], as.integer(got[2]), got[3], got[4], got[5]))
}
