# The environment of the lock, in which the commands of the README run. Binder and .devcontainer use it too.
#   docker build --tag slippulse .
#   docker run --name run slippulse                    both commands of the README
#   docker cp run:/slippulse/results results           the results, out of the container
FROM python:3.13-slim-bookworm
RUN apt-get update && apt-get install --yes --no-install-recommends git make \
    && rm -rf /var/lib/apt/lists/*
# Binder starts the image as this user.
ARG NB_USER=reader
ARG NB_UID=1000
RUN useradd --create-home --uid "$NB_UID" "$NB_USER" \
    && install --directory --owner="$NB_USER" /slippulse /slippulse/results
USER $NB_USER
WORKDIR /slippulse
# The environment is built again only when a lock changes.
COPY --chown=$NB_UID Makefile pyproject.toml README.md LICENSE requirements*.lock ./
COPY --chown=$NB_UID src src
RUN make setup notebook
COPY --chown=$NB_UID . .
ENV PATH="/slippulse/.venv/bin:$PATH"
CMD ["sh", "-c", "make replicate && make test"]
