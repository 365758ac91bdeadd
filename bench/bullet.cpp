/* Bullet's soft body, set up as somebody would who knows it and wants it to be fast. Built only where Bullet is.
 *
 *   links        the pairs in Skein's order, then ReoptimizeLinkOrder, which makes frames a sixth faster and leaves the
 *                same stretch; kLST = 1 is Bullet's hardest. (randomizeConstraints stretched three times as far.)
 *   iterations   piterations, all in one step of 1/60 s: the soft body does not have substeps of its own.
 *                viterations and diterations stay 0, as Bullet has them
 *   damping      kDP takes its share of the velocity once a step: 1 - exp(-drag/60)
 *   contact      nodes against rigid bodies (SDF_RS, the default) with kCHR = 1, kDF = 1 times the rigid body's
 *                friction; the ground is a box, because a plane has no distance field here. Voxels of 0.1 m: 0.25 m,
 *                the default, is as fast, and too coarse for the ball
 *   not used     faces and aerodynamics, self-collision, clusters, poses: nothing of them is asked of Skein either
 *   never sleeps, or it would stop solving */
#include "bench/bullet.h"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <memory>
#include <vector>

namespace {
constexpr double frame = 1.0 / 60;
constexpr double half_box = 10;
} // namespace

struct bullet_world {
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::unique_ptr<btSoftBody> soft;

    void add_rigid(btCollisionShape *shape, double height, double friction) {
        shapes.emplace_back(shape);
        btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shape);
        info.m_startWorldTransform.setOrigin(btVector3(0, btScalar(height), 0));
        info.m_friction = btScalar(friction);
        bodies.emplace_back(new btRigidBody(info));
        world.addRigidBody(bodies.back().get());
    }

    explicit bullet_world(const bullet_scene &scene) {
        btVector3 gravity(0, btScalar(-9.81), 0);
        world.setGravity(gravity);
        btSoftBodyWorldInfo &info = world.getWorldInfo();
        info.m_dispatcher = &dispatcher;
        info.m_broadphase = &broadphase;
        info.m_gravity = gravity;
        info.m_sparsesdf.Initialize();
        info.m_sparsesdf.setDefaultVoxelsz(btScalar(0.1));
        info.m_sparsesdf.Reset();
        if (scene.floor)
            add_rigid(new btBoxShape(btVector3(half_box, half_box, half_box)), scene.floor_height - half_box,
                      scene.friction);
        if (scene.ball) add_rigid(new btSphereShape(btScalar(scene.ball_radius)), scene.ball_height, scene.friction);
        make_soft_body(info, scene);
        world.addSoftBody(soft.get());
    }

    void make_soft_body(btSoftBodyWorldInfo &info, const bullet_scene &scene) {
        std::vector<btVector3> x;
        std::vector<btScalar> m;
        for (size_t i = 0; i < scene.particle_count; i++) {
            const double *p = scene.positions + 3 * i;
            x.emplace_back(btScalar(p[0]), btScalar(p[1]), btScalar(p[2]));
            m.push_back(btScalar(scene.masses[i]));
        }
        soft.reset(new btSoftBody(&info, int(x.size()), x.data(), m.data()));
        soft->m_materials[0]->m_kLST = 1;
        for (size_t e = 0; e < scene.pair_count; e++)
            soft->appendLink(int(scene.pairs[2 * e]), int(scene.pairs[2 * e + 1]), soft->m_materials[0]);
        btSoftBodyHelpers::ReoptimizeLinkOrder(soft.get());
        soft->m_cfg.piterations = scene.iterations;
        soft->m_cfg.kDP = btScalar(1 - std::exp(-scene.drag * frame));
        soft->m_cfg.kDF = 1;
        soft->m_cfg.kCHR = 1;
        soft->getCollisionShape()->setMargin(btScalar(scene.thickness));
        soft->setActivationState(DISABLE_DEACTIVATION);
    }

    ~bullet_world() {
        world.removeSoftBody(soft.get());
        for (auto &body : bodies) world.removeRigidBody(body.get());
    }
};

extern "C" bullet_world *bullet_create(const bullet_scene *scene) {
    return new bullet_world(*scene);
}

extern "C" void bullet_step(void *world) {
    static_cast<bullet_world *>(world)->world.stepSimulation(btScalar(frame), 0);
}

extern "C" void bullet_positions(const bullet_world *world, double *xyz) {
    for (int i = 0; i < world->soft->m_nodes.size(); i++)
        for (int k = 0; k < 3; k++) xyz[3 * i + k] = double(world->soft->m_nodes[i].m_x[k]);
}

extern "C" void bullet_destroy(bullet_world *world) {
    delete world;
}
